"""What effects make of the points of inspected doors."""
