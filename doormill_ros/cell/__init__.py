"""The cell as a whole: where things stand, and how a run of one door goes."""
