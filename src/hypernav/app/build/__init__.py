"""Builds objects from a configuration; only this room does."""
