"""Furnishing of rooms, one module per kind of room."""
