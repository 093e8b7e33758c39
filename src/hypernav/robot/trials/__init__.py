"""Trials of a real robot: finished searches, and what was measured by hand."""
