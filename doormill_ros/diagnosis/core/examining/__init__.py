"""Examine the causes of a model before they are named."""
