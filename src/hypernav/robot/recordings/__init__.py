"""Recordings of RGB-D cameras: a reader for every format, and one type of frame for all."""
