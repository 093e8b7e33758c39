"""habitat-sim's images of a scene, as a renderer of ours.

Uses only documented calls of habitat-sim 0.2.2 to 0.3.3: ``Simulator``,
``get_agent(0).set_state``, ``get_sensor_observations``, ``pathfinder`` (here only
``load_nav_mesh``), ``recompute_navmesh`` and ``NavMeshSettings``. Poses of the scene, z up, are
converted to Habitat's, y up, only here and in `path_finder`.
"""

import importlib
import math
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from jaxtyping import Float64, Int32

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MissingExtraError, SceneError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.core.world import RenderedView
from hypernav.worlds.config import NavmeshChoice
from hypernav.worlds.habitat.graphics import graphics_device
from hypernav.worlds.habitat.scene_dataset import scene_dataset
from hypernav.worlds.navmesh.robot_navmesh import is_computed
from hypernav.worlds.scenes.loading import OBJECTS_FILE
from hypernav.worlds.scenes.scene import Scene

_WITH_COLOURS, _WITHOUT = 0, 1  # habitat-sim draws what an agent has sensors for, so there are two
_OPTICAL_TO_GL = np.diag([1.0, -1.0, -1.0])
_SCENE_TO_HABITAT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


def require_habitat() -> ModuleType:
    """The module of habitat-sim.

    Raises:
        MissingExtraError: It is not installed, or a library that it needs.
    """
    try:
        return importlib.import_module("habitat_sim")
    except ImportError as error:
        if error.name != "habitat_sim":
            raise MissingExtraError(
                f"habitat-sim is installed but can't be loaded ({error}); for libEGL.so.1: "
                "apt-get install libegl1"
            ) from error
        raise MissingExtraError(
            "the world 'habitat' needs habitat-sim, which is not installed and which pip does not "
            "have; try: conda install habitat-sim headless -c conda-forge -c aihabitat (one for "
            "Python 3.11 or later and NumPy 2; those before tag v0.3.4 are for 3.9), or build it: "
            "https://github.com/facebookresearch/habitat-sim. The native world does not need it: "
            "leave out --world habitat"
        ) from error


class HabitatRenderer:
    """habitat-sim's images of one scene; satisfies `hypernav.core.world.Renderer`.

    Attributes:
        colours: Whether images are drawn; without, they are black. May change between two renders.
        path_finder: habitat-sim's path finder of the scene.
    """

    def __init__(
        self, scene: Scene, mesh: Path, robot: Embodiment, navmesh: NavmeshChoice = "auto"
    ) -> None:
        """Open a scene in habitat-sim.

        Args:
            scene: The same scene, read by our code, for the numbers of its instances.
            mesh: File of the scene.
            robot: Robot whose camera is simulated.
            navmesh: Which navigation mesh it walks on.

        Raises:
            MissingExtraError: habitat-sim is not installed, or there is no graphics device for it.
            NavmeshError: The file of the mesh can't be used.
            SceneError: habitat-sim can't open the scene, or has no navigation mesh for it.
        """
        habitat_sim = require_habitat()
        self.colours = True
        self._habitat = habitat_sim
        self._camera = robot.camera.intrinsics
        try:
            with scene_dataset(scene, mesh) as dataset:
                configuration = _configuration(habitat_sim, mesh, robot, dataset)
                self._simulator: Any = habitat_sim.Simulator(configuration)
        except (RuntimeError, ValueError, OSError) as error:
            raise SceneError(f"{mesh}: habitat-sim can't open it ({error})") from error
        self.path_finder: Any = self._simulator.pathfinder
        # The mesh that it has loaded may be for another robot, which it does not know yet.
        file = navmesh_of(scene, mesh)
        if is_computed(file, robot.body, navmesh):
            settings = _navmesh_settings(habitat_sim, robot)
            self._simulator.recompute_navmesh(self.path_finder, settings)
        elif file is not None:
            self.path_finder.load_nav_mesh(str(file))
        if not self.path_finder.is_loaded:
            self.close()
            raise SceneError(f"{mesh}: habitat-sim found no navigation mesh beside it")
        self._instances = _instance_numbers(scene, mesh)

    def render(self, camera: PinholeCamera, camera_to_scene: Transform) -> RenderedView:
        """Colour, depth and instances as habitat-sim draws them.

        Args:
            camera: Intrinsics; they must be those that the scene was opened with.
            camera_to_scene: Pose of the camera, optical to scene frame.

        Raises:
            SceneError: The camera is another one.
        """
        if camera != self._camera:
            raise SceneError("habitat-sim's camera is set when a scene is opened; open it again")
        state = self._habitat.AgentState()
        state.position = _SCENE_TO_HABITAT @ camera_to_scene.translation
        rotation = _SCENE_TO_HABITAT @ camera_to_scene.rotation @ _OPTICAL_TO_GL
        state.rotation = quaternion_of(rotation).tolist()
        agent = _WITH_COLOURS if self.colours else _WITHOUT
        self._simulator.get_agent(agent).set_state(state)
        seen = self._simulator.get_sensor_observations(agent)
        depth = np.asarray(seen["depth"], dtype=np.float32)
        ids = self._instances.take(seen["semantic"], mode="clip")
        black = np.zeros((*depth.shape, 3), dtype=np.uint8)
        return RenderedView(
            rgb=np.ascontiguousarray(seen["color"][..., :3]) if self.colours else black,
            depth=depth,
            instance_ids=np.where(depth > 0.0, ids, np.int32(-1)),
        )

    def close(self) -> None:
        """Close the simulator; the renderer is not used afterwards."""
        self._simulator.close()


def navmesh_of(scene: Scene, mesh: Path) -> Path | None:
    """The navigation mesh that habitat-sim walks on: the scene's own, or the file beside it.

    Args:
        scene: The scene, read by our code.
        mesh: File of the scene.
    """
    beside = mesh.with_suffix(".navmesh")
    return scene.navmesh or (beside if beside.is_file() else None)


def quaternion_of(rotation: Float64[np.ndarray, "3 3"]) -> Float64[np.ndarray, "4"]:
    """The quaternion ``[x, y, z, w]`` of a rotation matrix (Shepperd, 1978)."""
    trace = float(np.trace(rotation))
    largest = int(np.argmax([*np.diag(rotation), trace]))
    if largest == 3:
        w = math.sqrt(1.0 + trace) / 2.0
        skew = rotation - rotation.T
        return np.array([skew[2, 1], skew[0, 2], skew[1, 0], 4.0 * w * w]) / (4.0 * w)
    i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
    length = math.sqrt(1.0 + 2.0 * rotation[i, i] - trace)
    values = np.zeros(4)
    values[i] = length / 2.0
    values[j] = (rotation[i, j] + rotation[j, i]) / (2.0 * length)
    values[k] = (rotation[i, k] + rotation[k, i]) / (2.0 * length)
    values[3] = (rotation[k, j] - rotation[j, k]) / (2.0 * length)
    return values


def _configuration(
    habitat_sim: ModuleType, mesh: Path, robot: Embodiment, dataset: Path | None
) -> Any:
    simulator = habitat_sim.SimulatorConfiguration()
    simulator.scene_id = str(mesh)
    simulator.enable_physics = False
    simulator.gpu_device_id = graphics_device()
    if dataset is not None:
        simulator.scene_dataset_config_file = str(dataset)
    kinds = habitat_sim.SensorType
    shapes = {"depth": kinds.DEPTH, "semantic": kinds.SEMANTIC}
    agents = []
    for sensors in ({"color": kinds.COLOR, **shapes}, shapes):  # _WITH_COLOURS, _WITHOUT
        agent = habitat_sim.agent.AgentConfiguration()
        agent.sensor_specifications = [
            _sensor(habitat_sim, robot, name, kind) for name, kind in sensors.items()
        ]
        agents.append(agent)
    return habitat_sim.Configuration(simulator, agents)


def _navmesh_settings(habitat_sim: ModuleType, robot: Embodiment) -> Any:
    settings = habitat_sim.NavMeshSettings()
    settings.set_defaults()
    settings.agent_radius, settings.agent_height = robot.body.radius_m, robot.body.height_m
    return settings


def _sensor(habitat_sim: ModuleType, robot: Embodiment, name: str, kind: Any) -> Any:
    """A camera at the agent's own position; the agent is placed where the camera is."""
    sensor = habitat_sim.CameraSensorSpec()
    sensor.uuid = name
    sensor.sensor_type = kind
    sensor.sensor_subtype = habitat_sim.SensorSubType.PINHOLE
    sensor.resolution = [robot.camera.height, robot.camera.width]
    sensor.hfov = robot.camera.hfov_deg
    sensor.position = [0.0, 0.0, 0.0]
    return sensor


def _instance_numbers(scene: Scene, mesh: Path) -> Int32[np.ndarray, "numbers"]:
    """Our number of every annotated instance, by habitat-sim's number; 0 is the building.

    The last one is 0, too: that of every higher number.
    """
    if (mesh.parent / OBJECTS_FILE).is_file():  # our export, with instances numbered from 1
        return np.array([0, *range(len(scene.instances)), 0], dtype=np.int32)
    numbers = {0: 0}
    for instance in scene.instances[1:]:
        annotated = instance.name.rpartition("_")[2]
        if annotated.isdecimal():
            numbers[int(annotated)] = instance.id
    table = np.zeros(max(numbers) + 2, dtype=np.int32)
    for annotated, own in numbers.items():
        table[annotated] = own
    return table
