"""A controller's Robot Web Services, 1.0 (IRC5) and 2.0 (OmniCore), simulated on loopback."""
