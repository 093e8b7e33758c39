"""Exploration by numbered arrows in the camera image (VLMnav, PIVOT, DyNaVLM)."""
