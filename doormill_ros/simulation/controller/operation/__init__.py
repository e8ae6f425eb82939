"""Operating the simulated controller: its states, the orders it takes and what a stop does."""
