"""The top-down map from depth images, and what is derived from it."""
