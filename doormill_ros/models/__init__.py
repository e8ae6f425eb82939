"""Which robot model the cell mills with: versions, who put them in use, and what keeps the cell from milling."""
