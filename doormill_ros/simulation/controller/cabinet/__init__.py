"""What stands about the program: signals, pendant, rack."""
