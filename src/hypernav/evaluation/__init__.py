"""Running of episodes, and how well they went."""
