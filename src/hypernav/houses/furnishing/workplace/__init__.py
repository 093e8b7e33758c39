"""Furnishing of offices, one module per group of rooms."""
