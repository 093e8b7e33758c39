"""The same agents on a real machine."""
