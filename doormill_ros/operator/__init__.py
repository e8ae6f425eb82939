"""The operator's page: what the cell does, what to do next, why a door was refused."""
