"""A picture of the clamp without a door, and what it tells beside one with a door."""
