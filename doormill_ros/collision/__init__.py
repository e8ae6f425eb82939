"""Bodies in the cell: how far apart they are, whether a motion touches one, and a way past them."""
