"""Where the inspection of a door lies: a folder with a description and a table, often beside the bag of its run."""

from __future__ import annotations

DESCRIPTION, TABLE = "inspection.yaml", "points.csv"
BESIDE_BAG = "inspection"  #: folder of an inspection in the folder of its run
