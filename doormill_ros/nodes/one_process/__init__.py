"""The whole cell in one process, for one door or a shift."""
