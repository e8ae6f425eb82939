"""From a feature to the steps that mill it."""
