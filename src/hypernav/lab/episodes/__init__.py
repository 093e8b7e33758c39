"""Episodes run and recorded: an agent, a world, a referee who knows the truth, and a page of it."""
