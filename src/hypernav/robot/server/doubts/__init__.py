"""What a robot sends that may be misread: images and poses that don't fit each other."""
