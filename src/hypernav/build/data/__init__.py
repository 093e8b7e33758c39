"""Scenes and data sets by name: where buildings and episodes come from."""
