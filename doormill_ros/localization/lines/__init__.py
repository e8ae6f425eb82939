"""Lines through edge points, the pose of both together, and how far an edge wanders beside its line."""
