"""Parametric models of objects, one module per family."""
