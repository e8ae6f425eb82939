"""A door's way through the cell: picture to pose, pose and recipe to program, and the course of a run through both.

Whoever mills, replays, previews or questions a door goes this way. The room stands above `cell`, whose layout the
localizer and the path generator build on, and below the nodes.
"""
