"""Predefined routines of RAPID, one file for each field of work."""
