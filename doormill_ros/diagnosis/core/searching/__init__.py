"""Find which causes are worth a place in the model."""
