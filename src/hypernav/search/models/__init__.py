"""Neural networks, each with a small protocol and an optional extra."""
