"""Kinds of buildings: the differences of homes, offices and shops."""
