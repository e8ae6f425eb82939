"""What is told of a shift: charts, capability, what to measure next."""
