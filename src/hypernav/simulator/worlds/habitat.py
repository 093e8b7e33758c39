"""habitat-sim as a world, if it is installed: its images and its path finder.

Uses only documented calls of habitat-sim 0.2.2 to 0.3.3: ``Simulator``,
``get_agent(0).set_state``, ``get_sensor_observations``, ``pathfinder``, ``recompute_navmesh`` and
``NavMeshSettings``. Poses of the scene, z up, are converted to Habitat's, y up, only here.

habitat-sim ends the whole program if the given graphics device doesn't exist, so the devices are
listed first, with the EGL calls that habitat-sim's own context makes (Magnum,
``WindowlessEglApplication``): the devices of ``EGL_EXT_device_enumeration``, and the CUDA number of
each by ``EGL_NV_device_cuda``.

A scene-dataset configuration says how a scene stands and where its annotation lies. habitat-sim
takes a GLB without one for one of Matterport's, z up, so a scene of any other kind gets one here,
for as long as it is opened (attributes of stages; its own documentation, "Using JSON Files to
configure Attributes").
"""

import ctypes
import importlib
import json
import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np
from jaxtyping import Bool, Float64, Int32

from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MissingExtraError, SceneError, StartError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.core.world import Position, RenderedView
from hypernav.simulator.worlds.config import NavmeshChoice
from hypernav.simulator.worlds.navmesh.robot_navmesh import is_computed
from hypernav.simulator.worlds.scenes.loading import OBJECTS_FILE
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable_surface import floors_of_box, is_near_box

DEFAULT_DEVICE = -1
"""habitat-sim's number for EGL's default device."""

_CUDA_DEVICE = 0x323A  # EGL_CUDA_DEVICE_NV of EGL/eglext.h
_MOST_DEVICES = 64
_INSTALL = (
    "install a driver: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri (Mesa, which draws "
    "without a graphics card), or NVIDIA's with its EGL. The native world does not need it: leave "
    "out --world habitat"
)
_NAMES = (
    "hm3d_annotated_basis.scene_dataset_config.json",
    "hm3d_basis.scene_dataset_config.json",
    "mp3d.scene_dataset_config.json",
    "hypernav.scene_dataset_config.json",
)
_FOLDERS_ABOVE = 4
_WITH_COLOURS, _WITHOUT = 0, 1  # habitat-sim draws what an agent has sensors for, so there are two
_OPTICAL_TO_GL = np.diag([1.0, -1.0, -1.0])
_SCENE_TO_HABITAT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
_POINTS = 4000
_DRAWS = 1000
_NAVIGABLE_M = 0.5


def graphics_device() -> int:
    """The number of the device for ``SimulatorConfiguration.gpu_device_id``.

    Returns:
        The first CUDA device; `DEFAULT_DEVICE` if no device has CUDA. On systems other than
        Linux, where habitat-sim doesn't draw through EGL, its own default, 0.

    Raises:
        MissingExtraError: EGL is not installed, or has no device to draw with.
    """
    if sys.platform != "linux":
        return 0
    devices = egl_devices()
    if not devices:
        raise MissingExtraError(f"habitat-sim finds no device to draw with (EGL has 0); {_INSTALL}")
    return min((number for number in devices if number is not None), default=DEFAULT_DEVICE)


def egl_devices() -> list[int | None]:
    """The CUDA numbers of EGL's devices; None for a device without CUDA.

    Raises:
        MissingExtraError: EGL is not installed.
    """
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError as error:
        raise MissingExtraError(f"habitat-sim draws through EGL ({error}); {_INSTALL}") from error
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    addresses = [
        egl.eglGetProcAddress(name) for name in (b"eglQueryDevicesEXT", b"eglQueryDeviceAttribEXT")
    ]
    if None in addresses:
        return []
    query_devices = ctypes.CFUNCTYPE(
        ctypes.c_uint, ctypes.c_int, ctypes.POINTER(ctypes.c_void_p), ctypes.POINTER(ctypes.c_int)
    )(addresses[0])
    query_attribute = ctypes.CFUNCTYPE(
        ctypes.c_uint, ctypes.c_void_p, ctypes.c_int, ctypes.POINTER(ctypes.c_ssize_t)
    )(addresses[1])
    found, count = (ctypes.c_void_p * _MOST_DEVICES)(), ctypes.c_int(0)
    if not query_devices(_MOST_DEVICES, found, ctypes.byref(count)):
        return []
    numbers: list[int | None] = []
    for device in found[: count.value]:
        number = ctypes.c_ssize_t(0)
        has_cuda = query_attribute(device, _CUDA_DEVICE, ctypes.byref(number))
        numbers.append(number.value if has_cuda else None)
    return numbers


@contextmanager
def scene_dataset(scene: Scene, mesh: Path) -> Iterator[Path | None]:
    """The configuration of a scene; None where habitat-sim's own assumptions hold."""
    found = _above(mesh)
    if found is not None or scene.stored_z_up:
        yield found
        return
    with TemporaryDirectory() as folder:
        path = Path(folder) / "upright.scene_dataset_config.json"
        path.write_text(json.dumps(_upright(mesh)))
        yield path


def _above(mesh: Path) -> Path | None:
    """The configuration of a data set in a folder above a scene, which brings its annotation."""
    for folder in list(mesh.resolve().parents)[:_FOLDERS_ABOVE]:
        for name in _NAMES:
            if (folder / name).is_file():
                return folder / name
    return None


def _upright(mesh: Path) -> dict[str, object]:
    """Attributes of a scene that is y up, as glTF prescribes."""
    attributes = {"shader_type": "flat", "up": [0, 1, 0], "front": [0, 0, -1], "origin": [0, 0, 0]}
    stages = {"default_attributes": attributes, "paths": {".glb": [str(mesh.resolve())]}}
    return {"stages": stages}


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
    """The navigation mesh that habitat-sim walks on: the scene's own, or the file beside it."""
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


class HabitatSurface:
    """Where habitat-sim lets a robot stand: a `WalkableSurface`. Scene frame, z up, metres.

    Attributes:
        floor_z: Height of the main storey's floor: the median over the largest island.
    """

    def __init__(self, path_finder: Any) -> None:
        """Create it with habitat-sim's path finder of an opened scene."""
        self._finder = path_finder
        self.floor_z = float(np.median(self._floor[:, 2]))

    def is_on_storey(self, z: Float64[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
        """Whether heights belong to a storey; always True, because the mesh has all storeys."""
        return np.ones(len(z), dtype=bool)

    def height_at(self, x: float, y: float, z: float | None = None) -> float:
        """Height of the floor, metres; NaN where the robot can't stand."""
        if not self.is_standable(x, y, z):
            return math.nan
        return _position(self._finder.snap_point(self._point(x, y, z)))[2]

    def is_standable(self, x: float, y: float, z: float | None = None) -> bool:
        """Whether the robot fits here: the floor is at most 0.5 m higher or lower."""
        return bool(self._finder.is_navigable(self._point(x, y, z), _NAVIGABLE_M))

    def nearest_standable(self, x: float, y: float, z: float | None = None) -> Position:
        """The nearest position where the robot fits."""
        found = self._finder.snap_point(self._point(x, y, z))
        if not np.isnan(np.asarray(found)).any():
            return _position(found)
        here = np.array([x, y, self.floor_z if z is None else z])
        nearest = self._floor[np.argmin(((self._floor - here) ** 2).sum(axis=1))]
        return float(nearest[0]), float(nearest[1]), float(nearest[2])

    def move(self, position: Position, dx: float, dy: float, *, sliding: bool = False) -> Position:
        """End of a straight move, by habitat-sim's step filter."""
        x, y, z = position
        step = self._finder.try_step if sliding else self._finder.try_step_no_sliding
        return _position(step(self._point(x, y, z), self._point(x + dx, y + dy, z)))

    def distance(self, start: Position, end: Position) -> float:
        """Geodesic distance, metres; infinite if no path exists."""
        path = require_habitat().ShortestPath()
        path.requested_start, path.requested_end = self._point(*start), self._point(*end)
        return float(path.geodesic_distance) if self._finder.find_path(path) else math.inf

    def goal_field(self, goals: Float64[np.ndarray, "n 3"]) -> "HabitatField":
        """Shortest paths to the nearest of these positions."""
        return HabitatField(self._finder, goals, self.floor_z)

    def component_of(self, x: float, y: float, z: float | None = None) -> int:
        """Whether a point is on the largest island (0), on another (1) or on none (-1)."""
        if not self.is_standable(x, y, z):
            return -1
        return int(self._finder.get_island(self._point(x, y, z)) != self._island)

    def centres(self, component: int = 0) -> Float64[np.ndarray, "n 2"]:
        """Points spread over the largest island; no points for other islands."""
        return self._floor[:, :2] if component == 0 else np.zeros((0, 2))

    def floor_near(
        self, low: Position, high: Position, reach_m: float
    ) -> Float64[np.ndarray, "n 3"]:
        """Positions on the largest island within a distance of a box, on its storey."""
        near = self._floor[is_near_box(self._floor[:, :2], low[:2], high[:2], reach_m)]
        return near[floors_of_box(near[:, 2], low[2])]

    def random_point(self, rng: np.random.Generator) -> tuple[float, float]:
        """A point of the largest island, on the main storey.

        Raises:
            StartError: There is none.
        """
        for _ in range(_DRAWS):
            x, y, _ = self._floor[rng.integers(len(self._floor))].tolist()
            if self.is_standable(x, y):
                return x, y
        raise StartError("habitat-sim's navigation mesh has no main storey")

    @cached_property
    def _island(self) -> int:
        areas = [self._finder.island_area(k) for k in range(self._finder.num_islands)]
        return int(np.argmax(areas))

    @cached_property
    def _floor(self) -> Float64[np.ndarray, "n 3"]:
        """Points spread over the largest island, drawn by habitat-sim, the same each time."""
        self._finder.seed(0)
        drawn = [
            _position(self._finder.get_random_navigable_point(10, self._island))
            for _ in range(_POINTS)
        ]
        points = np.array(drawn, dtype=np.float64)
        return points[np.isfinite(points).all(axis=1)]

    def _point(self, x: float, y: float, z: float | None) -> Float64[np.ndarray, "3"]:
        return np.array([x, self.floor_z if z is None else z, -y])


class HabitatField:
    """habitat-sim's shortest paths to the nearest of a set of goals. Scene frame, metres."""

    def __init__(self, finder: Any, goals: Float64[np.ndarray, "n 3"], floor_z: float) -> None:
        """Create it for a set of goals."""
        self._finder, self._floor_z = finder, floor_z
        self._path: Any = require_habitat().MultiGoalShortestPath()
        self._has_goals = len(goals) > 0
        if self._has_goals:
            self._path.requested_ends = np.column_stack([goals[:, 0], goals[:, 2], -goals[:, 1]])

    def distance(self, x: float, y: float, z: float | None = None) -> float:
        """Geodesic distance; infinite if no path leads there."""
        return float(self._path.geodesic_distance) if self._found(x, y, z) else math.inf

    def path(self, x: float, y: float, z: float | None = None) -> list[tuple[float, float]]:
        """The path over all bends to the nearest goal, seen from above; empty if there is none."""
        points = self._path.points if self._found(x, y, z) else []
        return [(float(point[0]), -float(point[2])) for point in points]

    def _found(self, x: float, y: float, z: float | None) -> bool:
        if not self._has_goals:
            return False
        self._path.requested_start = np.array([x, self._floor_z if z is None else z, -y])
        return bool(self._finder.find_path(self._path))


def _position(point: Any) -> Position:
    return float(point[0]), -float(point[2]), float(point[1])
