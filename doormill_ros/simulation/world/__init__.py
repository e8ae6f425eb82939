"""How a simulated cell really is, read from a world file; shares nothing with the models that it judges."""
