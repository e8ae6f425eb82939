"""Where the robot works well: maps over the joints, and where to put its foot for a range of doors."""
