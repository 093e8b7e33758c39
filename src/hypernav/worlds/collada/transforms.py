"""Transforms of the nodes in a COLLADA document."""

import math
import xml.etree.ElementTree as ElementTree

import numpy as np
from jaxtyping import Float64

from hypernav.worlds.collada.triangles import numbers_of

_NUMBERS = {
    "matrix": 16,
    "bind_shape_matrix": 16,
    "translate": 3,
    "rotate": 4,
    "scale": 3,
    "lookat": 9,
}


def local_matrix(node: ElementTree.Element) -> Float64[np.ndarray, "4 4"]:
    """The transform of a node to its parent: its steps, the first applied last.

    Raises:
        ValueError: A step hasn't the numbers that it needs.
    """
    whole = np.eye(4)
    for step in node:
        if step.tag in _NUMBERS:
            values = numbers_of(step.text)
            if len(values) != _NUMBERS[step.tag]:
                raise ValueError(
                    f"{step.tag} has {len(values)} numbers, expected {_NUMBERS[step.tag]}"
                )
            whole = whole @ _matrix(step.tag, values)
    return whole


def _matrix(kind: str, values: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "4 4"]:
    if kind in ("matrix", "bind_shape_matrix"):
        return values.reshape(4, 4)
    matrix = np.eye(4)
    if kind == "translate":
        matrix[:3, 3] = values
    elif kind == "scale":
        matrix[:3, :3] = np.diag(values)
    elif kind == "rotate":
        matrix[:3, :3] = _turn(values[:3], math.radians(values[3]))
    else:
        eye, target, up = values.reshape(3, 3)
        back = _unit(eye - target)
        right = _unit(np.cross(up, back))
        matrix[:3, :3] = np.stack([right, np.cross(back, right), back], axis=1)
        matrix[:3, 3] = eye
    return matrix


def _turn(axis: Float64[np.ndarray, "3"], angle: float) -> Float64[np.ndarray, "3 3"]:
    x, y, z = _unit(axis)
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * across + (1.0 - math.cos(angle)) * across @ across


def _unit(vector: Float64[np.ndarray, "3"]) -> Float64[np.ndarray, "3"]:
    return vector / max(float(np.linalg.norm(vector)), 1e-12)
