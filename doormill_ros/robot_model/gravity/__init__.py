"""What an arm sags under its own weight and that of its tool."""
