"""Joint stiffness from loading tests."""
