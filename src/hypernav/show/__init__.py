"""Videos, images and pages out of a trace."""
