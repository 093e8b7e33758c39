"""Numbers of the generated houses, known without loading their generator."""

BUILTIN_HOUSE = 0
"""Number of the house that ships as the built-in scene: a small flat."""

VERSION = 1
"""Version of the generator; rises whenever a number gives another house than before."""
