"""The searches of a server: decisions, checks, what is kept on disk, and their threads."""
