"""Published trained navigation policies, whose weights are read from safetensors."""
