"""Random floor plans: rooms, doors, windows."""
