"""What `calibrate` does, command by command."""
