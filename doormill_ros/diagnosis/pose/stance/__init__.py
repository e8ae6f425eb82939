"""How the robot stands: along which direction gravity acts, and what hangs at the flange."""
