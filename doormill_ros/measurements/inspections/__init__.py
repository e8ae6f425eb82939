"""How milled doors came out."""
