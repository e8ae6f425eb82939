"""A cell that grows while it works: since when it is warm, the law of its growth, and that law in a model."""
