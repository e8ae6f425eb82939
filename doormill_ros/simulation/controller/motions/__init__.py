"""The arm, its paths and how fast they are driven."""
