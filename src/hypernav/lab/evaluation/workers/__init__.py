"""Workers that run the episodes of an evaluation: processes, or actors on a cluster."""
