"""Sets as a lab hands them over, one file a kind."""
