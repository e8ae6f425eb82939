"""Diagnosis of loading tests."""
