"""The loaded robot: joint springs, load cases, and the causes that make a loading test deviate from them."""
