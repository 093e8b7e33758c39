"""The robot's side of a search: it observes, asks the server, and executes each answer once."""
