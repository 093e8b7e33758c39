"""Rooms: what stands in which kind of them, and what was seen of them."""
