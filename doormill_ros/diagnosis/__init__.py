"""From measured data to what the simulation gets wrong: sets, causes, search, verdict, report."""
