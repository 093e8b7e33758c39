"""Searches to look at, on a server of robots or from a simulation of this program."""
