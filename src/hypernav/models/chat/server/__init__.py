"""Models behind an OpenAI-compatible server, and all that can go wrong on the way to one."""
