"""Scanned buildings in the file formats of HM3D and Matterport3D."""
