"""Orders to the cell, and the log of who gave them."""
