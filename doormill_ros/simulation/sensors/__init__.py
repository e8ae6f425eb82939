"""Simulated readings of every door sensor, from a true door pose and a seed."""
