"""Pictures in files, in folders and in compressed messages."""
