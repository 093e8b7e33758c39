"""The building itself: walls, floors, openings."""
