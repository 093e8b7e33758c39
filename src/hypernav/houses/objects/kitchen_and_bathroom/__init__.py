"""Pieces of kitchens, bathrooms and laundries."""
