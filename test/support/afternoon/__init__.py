"""An afternoon in a cell: door after door through the real executables, while something goes wrong all the time."""
