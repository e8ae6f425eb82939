"""Diagnosis of a cell from the bags of a series of runs alone, without a gauge."""
