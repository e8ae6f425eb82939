"""What the door sensors of a simulated cell read off a true door; shares no code with those that find it."""
