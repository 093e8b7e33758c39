"""Components by name: chosen, built, and what results must say of them."""
