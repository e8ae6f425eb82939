"""What stands between face and background along an edge: arrises, thin bands, and what hides them."""
