"""NavVLM: the area that a model points to."""
