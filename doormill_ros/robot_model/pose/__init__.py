"""The unloaded robot: displaced link frames, and the causes that put its tool elsewhere than it believes."""
