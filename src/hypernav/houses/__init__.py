"""Furnished houses, generated in code."""
