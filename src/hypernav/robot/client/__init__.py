"""The robot's side of a search: it observes, asks the server, and does what it is told, once."""
