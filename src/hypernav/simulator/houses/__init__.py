"""Procedural generation of furnished houses and of their episodes."""
