"""The memory on disk: its index, how it is read and written, and the folder that holds it."""
