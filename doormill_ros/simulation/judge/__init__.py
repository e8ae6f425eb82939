"""The judge of every executed motion: what the tool, the spindle and the arm touched on their way."""
