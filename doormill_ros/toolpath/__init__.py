"""From a recipe and a door pose to the targets and motions that mill the door."""
