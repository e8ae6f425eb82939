"""Causes of absolute pose errors, one file each."""
