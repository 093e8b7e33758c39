"""Rendering of scenes: colour, depth and instances."""
