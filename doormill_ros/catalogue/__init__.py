"""The catalogue of runs: a row each, filled as they end and made anew from their bags."""
