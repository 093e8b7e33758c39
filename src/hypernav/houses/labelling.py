"""Names and labels of all instances: category, looks, room and neighbours."""

from collections.abc import Sequence

import numpy as np

from hypernav.core.labels import ObjectLabel
from hypernav.houses.assembly import PlacedModel
from hypernav.houses.modelling.mesh import rotation_matrix

_NEAR_M = 0.45
_FLAT = ("rug", "doormat", "bath mat", "ceiling lamp", "chandelier", "curtain", "window", "door")


def name_and_label(pieces: Sequence[PlacedModel]) -> tuple[list[str], list[ObjectLabel | None]]:
    """Unique name of every piece, and its label if it can be a goal."""
    seen: dict[str, int] = {}
    names = []
    for piece in pieces:
        word = f"{piece.model.category} {piece.room}" if piece.structural else piece.model.category
        key = word.strip().replace(" ", "_")
        seen[key] = seen.get(key, 0) + 1
        names.append(f"{key}_{seen[key]}")
    boxes = np.array([bounding_box(p) for p in pieces])
    labels = [_label(k, pieces, boxes) for k in range(len(pieces))]
    return names, labels


def bounding_box(piece: PlacedModel) -> tuple[float, float, float, float, float, float]:
    """Axis-aligned bounding box in the scene: its lowest and highest corner, metres."""
    m = piece.model
    r = rotation_matrix(piece.yaw_deg)
    corners = [
        (x * r[0, 0] + y * r[0, 1], x * r[1, 0] + y * r[1, 1])
        for x in (m.low[0], m.high[0])
        for y in (m.low[1], m.high[1])
    ]
    xs, ys = [float(c[0]) + piece.x for c in corners], [float(c[1]) + piece.y for c in corners]
    return (min(xs), min(ys), piece.z + m.low[2], max(xs), max(ys), piece.z + m.high[2])


def _label(number: int, pieces: Sequence[PlacedModel], boxes: np.ndarray) -> ObjectLabel | None:
    piece = pieces[number]
    if piece.structural and piece.model.category != "window":
        return None
    model = piece.model
    attributes = tuple(dict.fromkeys(a for a in model.attributes if a))
    return ObjectLabel(
        model.category,
        tuple(s for s in model.synonyms if s != model.category),
        attributes,
        room_kind(piece.room),
        _beside(number, pieces, boxes),
    )


def room_kind(name: str) -> str:
    """Kind of a room by its name: "bedroom 2" is a "bedroom"."""
    head, _, tail = name.rpartition(" ")
    return head if tail.isdigit() else name


def _beside(number: int, pieces: Sequence[PlacedModel], boxes: np.ndarray) -> tuple[str, ...]:
    """Categories of the objects within 0.45 m, nearest first."""
    own = boxes[number]
    gap = np.maximum(np.maximum(boxes[:, :3] - own[3:], own[:3] - boxes[:, 3:]), 0.0)
    distance = np.sqrt((gap * gap).sum(axis=1))
    near = [k for k in np.argsort(distance, kind="stable") if distance[k] < _NEAR_M and k != number]
    kinds = [
        pieces[k].model.category
        for k in near
        if pieces[k].room == pieces[number].room
        and not pieces[k].structural
        and pieces[k].model.category not in _FLAT
    ]
    return tuple(dict.fromkeys(kinds))[:8]
