"""Where to send the robot so that the process force pushes it onto the nominal path."""
