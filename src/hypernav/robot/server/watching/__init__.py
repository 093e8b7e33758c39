"""Shows searches on the page: those of a robot server, or one simulated by this program."""
