"""The recipe database: versions that are never overwritten, in SQLite or PostgreSQL."""
