"""Video, pictures and pages out of a trace."""
