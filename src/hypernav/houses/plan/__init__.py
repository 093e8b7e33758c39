"""Floor plans: rooms, doors, windows."""
