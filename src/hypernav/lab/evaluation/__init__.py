"""Runs episodes and measures the results."""
