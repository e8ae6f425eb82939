"""Diagnosis of recordings of a moving robot with encoders on both sides of its gears."""
