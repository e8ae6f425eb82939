"""The true picture that a camera would take of a door."""
