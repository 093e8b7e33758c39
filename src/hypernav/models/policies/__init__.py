"""Trained navigation policies of others, whose weights are read from safetensors."""
