"""Construction: the one place where a configuration becomes objects."""
