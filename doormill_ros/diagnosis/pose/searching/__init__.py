"""Find which causes of pose errors are real."""
