"""Kinds of buildings: what a home, an office and a shop do differently."""
