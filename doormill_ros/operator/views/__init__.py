"""What the page shows of the cell, and what is to be done next."""
