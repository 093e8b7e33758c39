"""Episodes: Habitat's ObjectNav and OVON files, read and written."""
