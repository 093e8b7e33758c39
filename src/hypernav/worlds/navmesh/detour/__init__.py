"""Detour's questions to a navigation mesh, answered as its C++ code answers them.

The algorithms are those of Detour (Mikko Mononen and others, zlib licence, release 1.6.0) and of
habitat-sim's ``PathFinder`` (Meta Platforms, MIT licence), written anew.
"""
