"""Models of what stands in shops and libraries."""
