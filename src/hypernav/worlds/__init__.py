"""Whatever yields observations and takes actions."""
