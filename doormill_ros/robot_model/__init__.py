"""How a robot differs from rigid links with the published geometry: springs, causes of error, extended models."""
