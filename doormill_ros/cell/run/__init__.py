"""How a run of one door goes, in time."""
