"""Parametric furniture, one module per family."""
