"""The runs that ended, kept and searched."""
