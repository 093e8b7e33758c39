"""Scanned buildings as data sets store them: HM3D and Matterport3D."""
