"""The memory of a building in a folder: opened, shown in a notebook, drawn on a page."""
