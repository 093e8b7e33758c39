"""Searches on disk: what is needed to go on after a crash, and to look at them later."""
