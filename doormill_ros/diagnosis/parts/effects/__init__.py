"""What can be wrong with milled doors, one file a kind of effect; the list is in `registry`."""
