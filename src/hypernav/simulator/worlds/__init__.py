"""Worlds: they give observations and take actions."""
