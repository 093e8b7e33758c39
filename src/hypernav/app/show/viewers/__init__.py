"""Searches for rerun and Foxglove."""
