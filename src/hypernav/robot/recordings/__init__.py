"""Recordings of RGB-D cameras: a reader for every format, and a common frame for all."""
