"""The campaign of nodes that die: processes that are started again, an oracle at the controller's folder, a client."""
