"""The episodes of built-in splits, as files of this package in Habitat's format.

Beside them stands what their buildings are: a building that is drawn differently, for example
after a change of the generator, is refused, since figures would not be comparable.
"""

import json
from functools import cache
from pathlib import Path
from typing import Any

from hypernav.core.errors import SceneError
from hypernav.lab.datasets.building_splits import SPLITS
from hypernav.lab.datasets.habitat_files import read_episodes
from hypernav.lab.datasets.habitat_format import EpisodeDataset

SHIPPED = Path(__file__).with_name("shipped_splits")
"""Folder of the files: one of each split, and ``buildings.json``."""


def shipped_split(name: str) -> EpisodeDataset | None:
    """The episodes of a split without view points; None if it is not among the files."""
    path = SHIPPED / f"{name}.json.gz"
    return read_episodes(path) if path.is_file() else None


@cache
def shipped_buildings() -> dict[str, dict[str, dict[str, Any]]]:
    """What the buildings are, by split and number: a digest of geometry, and their view points."""
    return json.loads((SHIPPED / "buildings.json").read_text("utf-8"))


def check_geometry(kind: str, number: int, digest: str) -> None:
    """Refuse a building that is not the one for which the episodes of a split were made.

    Args:
        kind: Kind of the building, such as "houses".
        number: Its number.
        digest: Digest of its geometry as it was just drawn.

    Raises:
        SceneError: It is another one.
    """
    for name, buildings in shipped_buildings().items():
        recorded = buildings.get(str(number), {}).get("geometry", digest)
        if SPLITS[name].kind == kind and recorded != digest:
            raise SceneError(
                f"{kind}:{number} is drawn differently here (digest {digest}) than when the "
                f"episodes of {name} were made ({recorded}), so results would not be comparable; "
                "if you have changed the generator, give its splits new buildings, else please "
                "report processor and versions"
            )
