"""What a diagnosis of poses tells and shows."""
