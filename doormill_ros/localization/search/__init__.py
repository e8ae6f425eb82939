"""Where the edges of a door run in a picture, to a pixel or so, and which of several steps is the edge of its face."""
