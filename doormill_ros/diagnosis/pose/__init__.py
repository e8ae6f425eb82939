"""Diagnosis of absolute poses that a tracker took of an unloaded robot."""
