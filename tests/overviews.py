"""Overviews whose image is blank."""

import numpy as np

from hypernav.core.exploring.overview import Overview


class BlankOverview(Overview):
    """An overview whose image shows nothing."""

    def draw(self, shown, hatched) -> np.ndarray:
        """A black image of 64 × 64 pixels."""
        return np.zeros((64, 64, 3), np.uint8)
