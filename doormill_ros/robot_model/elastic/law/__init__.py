"""Laws without a name: where something acts, what drives it, and by which curve; models can carry them."""
