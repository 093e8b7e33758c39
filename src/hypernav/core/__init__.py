"""The vocabulary of hypernav: imports nothing else of the package."""
