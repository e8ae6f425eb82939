"""What shall be milled into a door: recipes, their checks, the database and the exchange files."""
