"""Real robots: the same agents behind a server, with clients, drivers and recordings."""
