"""Detour's queries of a navigation mesh, with the results of its C++ code.

The algorithms are those of Detour (Mikko Mononen and others, zlib licence, release 1.6.0) and of
habitat-sim's ``PathFinder`` (Meta Platforms, MIT licence), reimplemented.
"""
