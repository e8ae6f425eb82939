"""One file with everything that a site has of its own, and the way back into place."""
