"""Detectors by true labels of a simulated world: without faults, or with those of real ones."""
