"""The words of a diagnosis, and how far each of its decisions was from going the other way."""
