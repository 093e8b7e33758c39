"""Models behind an OpenAI-compatible server, with handling of all connection errors."""
