"""Components: their protocols, their optional abilities, and the registry of names."""
