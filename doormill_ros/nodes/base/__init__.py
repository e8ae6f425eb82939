"""What every node is made of: life cycle, parameters, diagnostics, topics, signs of life, frames."""
