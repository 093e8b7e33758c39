"""Whatever yields observations and takes actions: scenes, renderer, walkable surface, houses."""
