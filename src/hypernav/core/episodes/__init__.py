"""What an episode is, what is told of its truth, and how well it went."""
