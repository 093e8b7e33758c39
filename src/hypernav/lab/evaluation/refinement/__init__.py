"""The study of goal refinement: how many cells are off the goal, and whether areas lead to it."""
