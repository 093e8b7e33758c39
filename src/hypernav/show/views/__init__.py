"""Views of a search in programs that others made: rerun and Foxglove."""
