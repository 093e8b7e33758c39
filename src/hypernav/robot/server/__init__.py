"""The server: it receives the observations of robots, and an agent answers each."""
