"""Running episodes and telling how well they went."""
