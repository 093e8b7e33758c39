"""NavVLM: exploration of areas that a model points to in the camera image."""
