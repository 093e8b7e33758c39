"""Reads files from outside with limits, and writes files safely."""
