"""Replay: what the code now makes of a recorded run's inputs, compared with what was recorded."""
