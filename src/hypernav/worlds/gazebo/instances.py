"""Which parts of a Gazebo world are one thing."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hypernav.worlds.scenes.node_names import is_meaningful, unique_name
from hypernav.worlds.scenes.scene_assembly import MeshPart

_ROOM_M = 6.0
"""What is longer and wider is no single thing."""


@dataclass(frozen=True, eq=False)
class NamedPart:
    """A part and the names of what it belongs to.

    Attributes:
        names: Model, models within it, link, visual, node of the mesh file: from the outside in.
        part: The part.
    """

    names: tuple[str, ...]
    part: MeshPart


def named_instances(parts: Sequence[NamedPart]) -> list[MeshPart]:
    """The parts with one node for each thing.

    A model is one thing, called as the world calls it. One that is as large as a room is none, and
    the models, links, visuals and nodes within it are looked at in the same way.
    """
    taken: dict[str, int] = {}
    return [part for group in _things(parts, 1) for part in _as_one(group, taken)]


@dataclass(frozen=True, eq=False)
class _Thing:
    level: int
    parts: Sequence[NamedPart]


def _things(parts: Sequence[NamedPart], level: int) -> Iterator[_Thing]:
    groups: dict[tuple[str, ...], list[NamedPart]] = {}
    for part in parts:
        groups.setdefault(part.names[:level], []).append(part)
    for names, group in groups.items():
        has_more = any(len(part.names) > len(names) for part in group)
        if has_more and _is_large(group):
            yield from _things(group, level + 1)
        else:
            yield _Thing(len(names), group)


def _is_large(parts: Sequence[NamedPart]) -> bool:
    corners = np.concatenate([item.part.vertices[:, :2] for item in parts])
    corners = corners[np.isfinite(corners).all(axis=1)]
    return len(corners) > 0 and bool((np.ptp(corners, axis=0) > _ROOM_M).all())


def _as_one(thing: _Thing, taken: dict[str, int]) -> Iterator[MeshPart]:
    names = thing.parts[0].names
    node = unique_name("/".join(name for name in names[: thing.level] if name), taken)
    within = names[thing.level - 1 :]
    telling = next((name for name in within if is_meaningful(name)), names[thing.level - 1])
    for item in thing.parts:
        yield replace(item.part, node=node, descriptive_name=telling)
