"""Schema migrations of the recipe database, applied when it is opened."""
