"""Neural networks, each behind a small protocol and an optional extra."""
