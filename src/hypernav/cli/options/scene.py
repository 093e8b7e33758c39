"""The options of `hypernav scene`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro


@dataclass(frozen=True)
class Options:
    """What to make from a scene: `mesh`, the navigation mesh that habitat-sim would compute."""

    what: tyro.conf.Positional[Literal["mesh"]]
    """mesh"""
    scene: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="FILE")]
    """File of the scene, such as …/00802-wcojb4TFT35/wcojb4TFT35.basis.glb, or houses:N."""
    out: Path
    """File to write, such as wcojb4TFT35.navmesh."""
    radius: float = 0.18
    """Radius of the robot, metres."""
    height: float = 0.88
    """Height of the robot, metres."""
