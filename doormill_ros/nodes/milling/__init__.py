"""The action mill_door: its server, its shares, and what is asked and told on the way of a run."""
