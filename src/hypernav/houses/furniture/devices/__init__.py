"""Screens, lamps and electronics."""
