"""A GenICam camera on the network: its library, its line and its exposure."""
