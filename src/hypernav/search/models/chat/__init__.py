"""Models that look at images and answer in words."""
