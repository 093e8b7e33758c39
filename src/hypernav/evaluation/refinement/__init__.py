"""The study of goal refinement: how many cells lie off the goal, and whether areas lead to it."""
