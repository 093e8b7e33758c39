"""Pieces to sit, lie and work at, and to keep things in."""
