"""Episode files: Habitat's ObjectNav and OVON, read and written."""
