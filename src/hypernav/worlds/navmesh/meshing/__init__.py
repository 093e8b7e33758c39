"""Grids of standable cells turned into the polygons of a navigation mesh."""
