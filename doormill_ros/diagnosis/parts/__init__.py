"""Diagnosis from the inspection of milled parts."""
