"""Fit a list of causes to any kind of data by robust least squares, and score it on what was left out."""
