"""Furnishing of shops and libraries, one module per group of rooms."""
