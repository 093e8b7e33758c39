"""Drawing of maps with blocks, things, arrows and letters: for a model, and for people."""
