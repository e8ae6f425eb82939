"""The master's thesis behind the project: its tests, procedure, figures, contradictions, and their diagnosis."""
