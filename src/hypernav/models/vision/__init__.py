"""Networks that give boxes, masks and similarities."""
