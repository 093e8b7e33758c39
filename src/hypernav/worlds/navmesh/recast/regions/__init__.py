"""Regions of the open space."""
