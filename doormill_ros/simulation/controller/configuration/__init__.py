"""What is installed on a controller: signals, event routines, modules."""
