"""A robot controller in software: RAPID interpreter, signals, web services, arm, motions and process."""
