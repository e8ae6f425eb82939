"""What runs nodes: executors, start and end of a process, its command line."""
