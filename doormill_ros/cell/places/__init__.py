"""Where door, tools, robot and clamp stand in the cell."""
