"""What the diagnosis leaves for the correction of paths."""
