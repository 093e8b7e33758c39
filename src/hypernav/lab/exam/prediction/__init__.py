"""What answers are worth in searches, and what an examined model would reach in them."""
