"""Names of things: words, labels, and how large things of a kind are."""
