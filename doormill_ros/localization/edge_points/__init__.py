"""Points of an edge to a part of a pixel: blurred steps fitted to rows across it."""
