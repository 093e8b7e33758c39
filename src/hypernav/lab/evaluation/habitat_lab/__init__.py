"""Environments with the observations, actions and measures of habitat-lab's ObjectNav task."""
