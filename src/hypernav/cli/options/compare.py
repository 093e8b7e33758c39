"""The options of `hypernav compare`."""

from dataclasses import dataclass
from pathlib import Path

import tyro

from hypernav.build.component_specs import BenchmarkName


@dataclass(frozen=True)
class Options:
    """The scene, the robot, and how many poses are compared."""

    scene: tyro.conf.Positional[Path]
    """File of the scene, such as …/00802-wcojb4TFT35/wcojb4TFT35.basis.glb."""
    benchmark: BenchmarkName = "hm3d"
    """Published robot whose camera and steps are compared."""
    poses: int = 20
    """Number of random poses."""
    seed: int = 0
    """Seed of the poses."""
