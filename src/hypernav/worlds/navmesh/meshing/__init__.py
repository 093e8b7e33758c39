"""Turns grids of standable cells into the polygons of a navigation mesh."""
