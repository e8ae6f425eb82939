"""Cutting speeds and feeds, and the process forces that bend the robot while it mills."""
