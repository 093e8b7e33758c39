"""The server: it takes the observations of robots, and lets an agent answer each."""
