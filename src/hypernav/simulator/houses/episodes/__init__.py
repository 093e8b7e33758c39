"""Splits and episodes of the generated houses, in Habitat's ObjectNav format."""
