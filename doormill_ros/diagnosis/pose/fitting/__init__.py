"""Fit causes to series of poses, and judge the fit on rows and series left out."""
