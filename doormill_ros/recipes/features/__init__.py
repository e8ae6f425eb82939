"""The family of features that can be milled into a door, one file a kind."""
