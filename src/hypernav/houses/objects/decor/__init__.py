"""Models of plants, textiles, ornaments and wall decoration."""
