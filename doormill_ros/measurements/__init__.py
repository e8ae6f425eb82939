"""What was measured, read from files: loading tests, poses, raw recordings, pictures."""
