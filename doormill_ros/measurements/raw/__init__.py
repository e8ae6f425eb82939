"""What the instruments wrote."""
