"""The folder of a run, which survives everything."""
