"""Descriptions and tables of measured data."""
