"""The classification of failed episodes."""
