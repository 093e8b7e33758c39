"""Videos, images and pages made from a trace."""
