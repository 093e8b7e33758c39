"""The navigation mesh that a robot walks on in a scene: that of the file, or one computed for it.

A building with several storeys, named or found, gets one, too, if the robot climbs stairs. For a
robot that doesn't, its storeys are apart, and the drop at the head of stairs is the end of the
floor; its mesh would lead over the stairs, because habitat-lab's agents climb 0.2 m.

habitat-sim, as configured by habitat-lab, computes a new mesh if the file beside a scene was made
for another robot than the agent (``Simulator::reconfigure``).
"""

import hashlib
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from hypernav.core.embodiment import BodyConfig
from hypernav.io.kept_arrays import digest_of, kept_arrays
from hypernav.simulator.worlds.config import NavmeshChoice
from hypernav.simulator.worlds.navmesh.file_format import is_mesh_of, settings_for
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of, read_navmesh
from hypernav.simulator.worlds.navmesh.recast_detour.recast_build import compute_navmesh
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.storey_floors import Storeys

_HALF_ANGLE = np.float32(0.70710683)
"""habitat-sim's sine and cosine of half a right angle: a rounding error above the true ones."""


def habitat_vertices(scene: Scene) -> Float32[np.ndarray, "v 3"]:
    """All vertices of a scene in Habitat's frame, metres, equal to habitat-sim's.

    A scan is stored z up. habitat-sim turns it by a matrix in single precision that is not exactly
    a rotation (``CoordinateFrame::rotationFrameToWorld``), which sometimes changes a voxel.
    """
    x, y, z = scene.vertices.T
    if not scene.stored_z_up:
        return np.ascontiguousarray(np.stack([x, z, -y], axis=1))
    turned = np.float32(2.0) * (_HALF_ANGLE * _HALF_ANGLE)
    left = np.float32(1.0) - turned
    return np.ascontiguousarray(
        np.stack([x, left * y + turned * z, -turned * y + left * z], axis=1)
    )


def storeys_on_mesh(scene: Scene, body: BodyConfig, choice: NavmeshChoice) -> Storeys | None:
    """Storeys of a building whose mesh leads over all of them; None if it has one, or is a scan.

    Raises:
        SceneError: The scene is too large to be in metres.
    """
    if choice == "auto" and not body.climbs_stairs:
        return None
    if scene.storeys:
        return Storeys.of(scene, body)
    if choice != "auto" or scene.navmesh is not None:
        return None
    found = Storeys.of(scene, body)
    return found if len(found.heights) > 1 else None


def robot_navmesh(
    scene: Scene, body: BodyConfig, choice: NavmeshChoice, *, has_storeys: bool = False
) -> Navmesh | None:
    """The mesh that a robot walks on; None if there is no file and none is to be computed.

    Args:
        scene: The scene.
        body: The robot.
        choice: Which mesh.
        has_storeys: Whether the building has several storeys, if the scene doesn't say so.

    Raises:
        NavmeshError: The file can't be used, or there is nothing to walk on.
    """
    has_stairs = choice == "auto" and (has_storeys or bool(scene.storeys))
    # A scan has a mesh for every robot, as in habitat-sim: its storeys are not known.
    if has_stairs and not body.climbs_stairs:
        return None
    if is_computed(scene.navmesh, body, choice) or (has_stairs and scene.navmesh is None):
        return Navmesh(navmesh_of(computed_for(scene, body)))
    return None if scene.navmesh is None else Navmesh.load(scene.navmesh)


def is_computed(file: Path | None, body: BodyConfig, choice: NavmeshChoice) -> bool:
    """Whether a robot walks on a mesh that is computed for it.

    Args:
        file: Mesh that comes with the scene; None if there is none.
        body: The robot.
        choice: Which mesh.

    Raises:
        NavmeshError: The file can't be used.
    """
    if choice == "auto":
        return file is not None and not is_mesh_of(read_navmesh(file).settings, body)
    return choice == "robot"


def computed_for(scene: Scene, body: BodyConfig) -> bytes:
    """The file of the mesh that habitat-sim would compute for a robot; from the cache if there.

    Raises:
        NavmeshError: There is nothing to walk on, or more than a mesh can hold.
    """
    settings = settings_for(body)
    robot = hashlib.sha256(settings.tobytes()).hexdigest()[:16]

    def compute() -> dict[str, np.ndarray]:
        content = compute_navmesh(habitat_vertices(scene), scene.faces, settings)
        return {"file": np.frombuffer(content, dtype=np.uint8)}

    return kept_arrays(scene.cache, f"navmesh-{robot}-{_version()}", compute)["file"].tobytes()


@lru_cache(maxsize=1)
def _version() -> str:
    """A name that changes with the code that computes meshes."""
    return digest_of(sorted(Path(__file__).parent.rglob("*.py")))
