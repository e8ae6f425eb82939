"""The HTML page that tells how a run went, from its bag."""
