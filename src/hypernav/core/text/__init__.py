"""Text from people and for people."""
