"""Models of screens, lamps and electronic devices."""
