"""Houses for other programs: glTF, Habitat, and a page for people."""
