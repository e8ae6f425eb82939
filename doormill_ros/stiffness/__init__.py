"""Elastostatics: how far a loaded robot gives way, and how stiff it is where."""
