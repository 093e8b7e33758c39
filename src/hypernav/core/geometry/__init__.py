"""Transforms, cameras, boxes and grids."""
