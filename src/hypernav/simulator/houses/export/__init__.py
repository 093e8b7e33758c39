"""Export of houses: glTF files, Habitat's metadata, web pages."""
