"""Pictures for surfaces, painted by numbers."""
