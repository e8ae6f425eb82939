"""What can be wrong with a simulated loading test, one file a cause; the list is in `registry`."""
