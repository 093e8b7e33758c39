"""A brain for the scripted server that really looks: at plain colours and red rectangles."""

import json

import numpy as np

from hypernav.core.geometry.boxes import Box
from hypernav.search.models.chat.vlm_families import family_named
from servers.scripted import Asked

_ESSAY = "A robot is a machine that senses and acts. It may drive around a house."


class SeeingBrain:
    """Answers what a healthy model answers, in the coordinates of a family."""

    def __init__(self, family: str = "qwen2.5-vl", *, scale: float = 1.0) -> None:
        self._family = family_named(family)
        self._scale = scale

    def __call__(self, asked: Asked) -> str:
        if asked.text.startswith("What colour"):
            red, green, blue = asked.images[0].reshape(-1, 3).mean(axis=0)
            return "It is blue." if blue > max(red, green) else "Green"
        match asked.kind:
            case "ground":
                return json.dumps([{"bbox_2d": self._red(asked.images[0]), "label": "red"}])
            case "choose block":
                return f"One room alone is open.\nAnswer: {self.open_room(asked.images[0])}"
            case "verify" | "crop":
                return "yes" if self._is_red(asked.images[0]).any() else "no"
        return _ESSAY

    @staticmethod
    def open_room(image: np.ndarray) -> int:
        """Number of the quarter of a drawn house whose outer wall is missing."""
        dark = image.max(axis=2) < 90
        rows, columns = (np.flatnonzero(dark.mean(axis=axis) > 0.3) for axis in (1, 0))
        top, bottom, left, right = rows[0], rows[-1], columns[0], columns[-1]
        middle = (top + bottom) // 2
        walls = [
            dark[top:middle, left : left + 9],
            dark[top:middle, right - 8 : right + 1],
            dark[middle:bottom, left : left + 9],
            dark[middle:bottom, right - 8 : right + 1],
        ]
        return 1 + int(np.argmin([wall.any(axis=1).mean() for wall in walls]))

    @staticmethod
    def _is_red(image: np.ndarray) -> np.ndarray:
        pixels = image.astype(int)
        return (pixels[..., 0] > 150) & (pixels[..., 1] < 100)

    def _red(self, image: np.ndarray) -> list[float]:
        red = self._is_red(image)
        rows, columns = np.nonzero(red)
        height, width = red.shape
        x, y = 640 / width, 480 / height
        box = Box(columns.min() * x, rows.min() * y, (columns.max() + 1) * x, (rows.max() + 1) * y)
        said = self._family.from_image(box, 640, 480)
        edges = [said.x_min, said.y_min, said.x_max, said.y_max]
        if self._family.rows_first:
            edges = [edges[1], edges[0], edges[3], edges[2]]
        return [round(float(edge) * self._scale, 3) for edge in edges]
