"""A stand-in for habitat-sim: the few calls that are used, in its own frame, y up.

It draws what our renderer draws, and walks on the mesh as our reader reads it; how a state becomes
a camera in the scene is its own arithmetic, from the quaternion on.
"""

import json
import sys
from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hypernav.core.embodiment import BodyConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Transform
from hypernav.simulator.worlds import habitat
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.navmesh.navmesh import GoalPaths, Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of
from hypernav.simulator.worlds.navmesh.robot_navmesh import computed_for
from hypernav.simulator.worlds.scans.scan_loading import ScanFiles, open_scene
from hypernav.simulator.worlds.scenes.scene import Scene


def install(monkeypatch: pytest.MonkeyPatch, cuda: Sequence[int | None] = (None,)) -> None:
    """Let `import habitat_sim` find this module, on a machine with these devices of EGL."""
    monkeypatch.setitem(sys.modules, "habitat_sim", sys.modules[__name__])
    monkeypatch.setattr(habitat, "egl_devices", lambda: list(cuda))


class SensorType(Enum):
    COLOR = 1
    DEPTH = 2
    SEMANTIC = 3


class SensorSubType(Enum):
    PINHOLE = 1


class CameraSensorSpec(SimpleNamespace):
    """Attributes are set one by one, as on the real one."""


class SimulatorConfiguration(SimpleNamespace):
    pass


class AgentState(SimpleNamespace):
    pass


class _AgentConfiguration(SimpleNamespace):
    pass


agent = SimpleNamespace(AgentConfiguration=_AgentConfiguration)


class Configuration:
    def __init__(self, sim_cfg: Any, agents: list[Any]) -> None:
        self.sim_cfg, self.agents = sim_cfg, agents


class ShortestPath:
    def __init__(self) -> None:
        self.requested_start: Any = None
        self.requested_end: Any = None
        self.geodesic_distance = float("inf")
        self.points: list[Any] = []


class MultiGoalShortestPath(ShortestPath):
    def __init__(self) -> None:
        super().__init__()
        self.requested_ends: Any = None


class PathFinder:
    """habitat-sim's path finder over one mesh."""

    def __init__(self) -> None:
        self._mesh: Any = None
        self._rng = np.random.default_rng(0)

    @property
    def is_loaded(self) -> bool:
        return self._mesh is not None

    def load_nav_mesh(self, path: str) -> bool:
        self._mesh = Navmesh.load(Path(path))
        return True

    def take(self, content: bytes) -> None:
        self._mesh = Navmesh(navmesh_of(content))

    @property
    def num_islands(self) -> int:
        return len(self._mesh.areas_m2)

    def island_area(self, island: int) -> float:
        return float(self._mesh.areas_m2[island])

    def get_island(self, point: Any) -> int:
        return self._mesh.island_of(tuple(point))

    def seed(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)

    def get_random_navigable_point(self, max_tries: int = 10, island_index: int = -1) -> Any:
        assert max_tries > 0
        return np.array(self._mesh.random_point(self._rng, island_index))

    def snap_point(self, point: Any, island_index: int = -1) -> Any:
        found = self._mesh.nearest(tuple(point), None if island_index < 0 else island_index)
        return np.full(3, np.nan) if found is None else np.array(found)

    def is_navigable(self, point: Any, max_y_delta: float = 0.5) -> bool:
        return self._mesh.is_navigable(tuple(np.asarray(point).tolist()), max_y_delta)

    def try_step(self, start: Any, end: Any) -> Any:
        return np.array(self._mesh.try_step(tuple(start), tuple(end), sliding=True))

    def try_step_no_sliding(self, start: Any, end: Any) -> Any:
        return np.array(self._mesh.try_step(tuple(start), tuple(end), sliding=False))

    def find_path(self, path: Any) -> bool:
        if isinstance(path, MultiGoalShortestPath):
            ends = np.asarray(path.requested_ends)
            found = GoalPaths(self._mesh, ends).nearest(tuple(path.requested_start))[1]
        else:
            start, end = tuple(path.requested_start), tuple(path.requested_end)
            found = self._mesh.shortest_path(start, end)
        path.geodesic_distance, path.points = found.length_m, list(found.points)
        return np.isfinite(found.length_m)


class NavMeshSettings(SimpleNamespace):
    def set_defaults(self) -> None:
        self.agent_radius, self.agent_height = 0.1, 1.5


class _Agent:
    def __init__(self) -> None:
        self.state: Any = None

    def set_state(self, state: Any) -> None:
        assert len(state.rotation) == 4
        assert np.isclose(np.linalg.norm(state.rotation), 1.0)
        self.state = state


class Simulator:
    def __init__(self, configuration: Configuration) -> None:
        device = configuration.sim_cfg.gpu_device_id
        if device not in (-1, *habitat.egl_devices()):
            raise SystemExit(f"unable to find CUDA device {device}")  # the real one ends, too
        path = Path(configuration.sim_cfg.scene_id)
        scene = open_scene(path)
        # The real one takes a GLB for z up unless its configuration says otherwise.
        assert scene.stored_z_up or _stands_upright(configuration.sim_cfg, path)
        # The real one has the mesh of the file already, for whichever robot that was made.
        self.pathfinder = PathFinder()
        self._scene = scene
        self._renderer = CpuRenderer(scene, RenderConfig(threads=1))
        self._numbers = np.array(_annotated(path, scene), dtype=np.uint32)
        self._sensors = [agent.sensor_specifications for agent in configuration.agents]
        self._agents = [_Agent() for _ in configuration.agents]
        self.is_closed = False

    def get_agent(self, number: int) -> _Agent:
        return self._agents[number]

    def get_sensor_observations(self, agent_ids: int = 0) -> dict[str, Any]:
        seen: dict[str, Any] = {}
        state = self._agents[agent_ids].state
        for sensor in self._sensors[agent_ids]:
            height, width = sensor.resolution
            camera = PinholeCamera.from_hfov(width, height, float(sensor.hfov))
            view = self._renderer.render(camera, _camera_to_scene(state, sensor))
            if sensor.sensor_type is SensorType.COLOR:
                opaque = np.full((height, width, 1), 255, np.uint8)
                seen[sensor.uuid] = np.concatenate([view.rgb, opaque], axis=2)
            elif sensor.sensor_type is SensorType.DEPTH:
                seen[sensor.uuid] = view.depth
            else:
                numbers = self._numbers[np.maximum(view.instance_ids, 0)]
                seen[sensor.uuid] = np.where(view.instance_ids >= 0, numbers, 0)
        return seen

    def recompute_navmesh(self, path_finder: PathFinder, settings: NavMeshSettings) -> bool:
        robot = BodyConfig(radius_m=settings.agent_radius, height_m=settings.agent_height)
        path_finder.take(computed_for(self._scene, robot))
        return True

    def close(self) -> None:
        self._renderer.close()
        self.is_closed = True


def _camera_to_scene(state: AgentState, sensor: Any) -> Transform:
    """OpenGL's camera: x right, y up, looking along -z; Habitat's world: y up."""
    x, y, z, w = state.rotation
    right = _turned((x, y, z, w), (1.0, 0.0, 0.0))
    up = _turned((x, y, z, w), (0.0, 1.0, 0.0))
    back = _turned((x, y, z, w), (0.0, 0.0, 1.0))
    offset = np.column_stack([right, up, back]) @ np.array(sensor.position)
    middle = np.array(state.position) + offset
    columns = [_in_scene(right), _in_scene(-up), _in_scene(-back)]
    return Transform(np.column_stack(columns), _in_scene(middle))


def _annotated(path: Path, scene: Scene) -> list[int]:
    """habitat-sim's number of every instance: that of its line in the semantic text."""
    if ScanFiles.of(path) is not None:
        return [0, *(int(instance.name.rpartition("_")[2]) for instance in scene.instances[1:])]
    lines = path.with_suffix(".semantic.txt").read_text().splitlines()[1:]
    return [int(line.split(",")[0]) for line in lines]


def _stands_upright(settings: SimulatorConfiguration, mesh: Path) -> bool:
    configuration = Path(settings.scene_dataset_config_file)
    stages = json.loads(configuration.read_text())["stages"]
    known = [(configuration.parent / name).resolve() for name in stages["paths"][".glb"]]
    return mesh.resolve() in known and stages["default_attributes"]["up"] == [0, 1, 0]


def _turned(quaternion: tuple[float, ...], vector: tuple[float, ...]) -> np.ndarray:
    axis, w = np.array(quaternion[:3]), quaternion[3]
    v = np.array(vector)
    return v + 2.0 * np.cross(axis, np.cross(axis, v) + w * v)


def _in_scene(vector: np.ndarray) -> np.ndarray:
    return np.array([vector[0], -vector[2], vector[1]])
