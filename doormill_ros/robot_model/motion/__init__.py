"""The moving robot: what lies between the encoders on both sides of a gear, and the causes that put it there."""
