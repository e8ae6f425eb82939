"""From steps to corrected targets, and those to a program."""
