"""Lines and arcs, and what the tool goes along."""
