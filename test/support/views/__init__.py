"""A second world of pictures: the corner of a door as a solid thing among others, traced ray by ray."""
