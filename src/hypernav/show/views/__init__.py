"""Views of a search in other programs: rerun and Foxglove."""
