"""Why an episode failed."""
