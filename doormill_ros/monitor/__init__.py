"""Inspected doors and bags of runs as they come, questioned by the diagnosis beside the running cell; what follows."""
