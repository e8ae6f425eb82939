"""Joint stiffness from loading tests: raw files, the thesis' formulas, weighted least squares."""
