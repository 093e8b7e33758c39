"""The video of an episode."""
