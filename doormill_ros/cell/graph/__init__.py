"""The nodes and topics of a cell by their names, and whether they are ready."""
