"""The robot as an arrow, on maps and in their legend."""

import math

import numpy as np
from jaxtyping import UInt8

from hypernav.show.drawing import palette, shapes

# Tip, left wing, notch, right wing, as shares of the arrow's radius; x is ahead.
_ARROW = np.array([[1.0, 0.0], [-0.76, 0.64], [-0.38, 0.0], [-0.76, -0.64]])


def draw_arrow(
    image: UInt8[np.ndarray, "_ _ 3"], at: tuple[float, float], yaw: float, radius: float
) -> None:
    """Draw a robot, in place.

    Args:
        image: RGB.
        at: Centre of the arrow, pixels.
        yaw: Heading, radians counter-clockwise from the image's right.
        radius: Radius of the disc that holds the arrow, pixels.
    """
    c, s = math.cos(yaw), math.sin(yaw)
    turned = np.stack([_ARROW @ (c, -s), -(_ARROW @ (s, c))], axis=1)
    rim = np.array(at) + turned * (radius - 1.0)
    shapes.polygon(image, [rim], palette.FREE)
    shapes.line(image, rim, palette.FREE, 3.0, closed=True)
    shapes.polygon(image, [np.array(at) + turned * (radius - 3.0)], palette.ROBOT)
