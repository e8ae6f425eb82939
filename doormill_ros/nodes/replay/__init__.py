"""A recorded run, repeated with the nodes."""
