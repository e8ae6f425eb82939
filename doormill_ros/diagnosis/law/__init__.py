"""What follows a diagnosis that leaves something: laws without a name, found and told."""
