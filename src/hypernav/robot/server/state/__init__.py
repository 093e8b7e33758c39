"""Searches on disk, to go on after a crash and to be looked at later."""
