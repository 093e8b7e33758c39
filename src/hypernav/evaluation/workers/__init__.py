"""Processes and clusters that run the episodes of an evaluation."""
