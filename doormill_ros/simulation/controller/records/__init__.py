"""What the robot did, and runs played again."""
