"""Search in another simulator: MuJoCo draws, hypernav moves the robot and knows what is true.

A world needs two things from a simulator: its shapes, from which hypernav computes where a robot
fits and where a goal counts as reached, and its pictures (colours, depth, and which object each
pixel shows). All else, from `hypernav find` to the tables of `hypernav eval`, stays as it is.

Run: pip install mujoco; python examples/08_mujoco_world.py

Saved as mujoco_world.py, it serves on the command line, in the same folder:
hypernav find chair --world mujoco_world:mujoco_world
"""

import math
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

import hypernav
from hypernav import HyPerNavConfig, PinholeCamera, RenderedView, SimulatedWorld, Transform

if sys.platform == "linux":
    os.environ.setdefault("MUJOCO_GL", "egl")  # draws without a screen
import mujoco

_PARTS = """
floor     3    2    0.05   3    2    -0.05  0.55 0.45 0.35
wall_1    3    0.05 1.25   3    0     1.25  0.85 0.85 0.80
wall_2    3    0.05 1.25   3    4     1.25  0.85 0.85 0.80
wall_3    0.05 2    1.25   0    2     1.25  0.80 0.85 0.85
wall_4    0.05 2    1.25   6    2     1.25  0.80 0.85 0.85
wall_5    0.05 1.3  1.25   3    1.3   1.25  0.80 0.85 0.85
table     0.6  0.4  0.35   1.2  3.2   0.35  0.40 0.25 0.15
bed       1    0.5  0.25   4.5  3.3   0.25  0.25 0.30 0.60
chair     0.25 0.25 0.45   5.3  0.6   0.45  0.70 0.20 0.15
"""
"""Two rooms of boxes: name, half sizes and middle (metres), colour."""


def room() -> Any:
    """MuJoCo's model of the rooms, with a camera that can be moved."""
    spec = mujoco.MjSpec()
    spec.visual.headlight.ambient = [0.45, 0.45, 0.45]
    spec.visual.map.znear, spec.visual.map.zfar = 0.005, 20.0  # times the size of the model
    for line in _PARTS.split("\n")[1:-1]:
        name, *numbers = line.split()
        size, middle, colour = np.array(numbers, dtype=float).reshape(3, 3)
        box = mujoco.mjtGeom.mjGEOM_BOX
        spec.worldbody.add_geom(name=name, type=box, size=size, pos=middle, rgba=[*colour, 1.0])
    spec.worldbody.add_body(name="head", mocap=True).add_camera(name="eye")
    return spec.compile()


def shapes(model: Any) -> hypernav.Scene:
    """The same boxes for hypernav: nodes of a file, whose names are the labels of the objects."""
    scene = trimesh.Scene()
    for geom in range(model.ngeom):
        box = trimesh.creation.box(2.0 * model.geom_size[geom])
        place = trimesh.transformations.translation_matrix(model.geom_pos[geom])
        scene.add_geometry(box, node_name=model.geom(geom).name, transform=place)
    scene.apply_transform(trimesh.transformations.rotation_matrix(-math.pi / 2.0, [1, 0, 0]))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mujoco_room.glb"  # glTF is y up, and hypernav turns it back
        scene.export(file)
        return hypernav.load_scene(file)


class MujocoCamera:
    """MuJoCo's pictures, as `hypernav.Renderer` asks for them."""

    def __init__(self, model: Any, scene: hypernav.Scene) -> None:
        self.colours = True
        self._model, self._data = model, mujoco.MjData(model)
        numbers = {instance.name: instance.id for instance in scene.instances}
        names = [model.geom(geom).name for geom in range(model.ngeom)]
        self._instances = np.array([*(numbers[name] for name in names), -1], dtype=np.int32)
        self._renderer: Any = None

    def render(self, camera: PinholeCamera, camera_to_scene: Transform) -> RenderedView:
        if self._renderer is None:
            self._renderer = mujoco.Renderer(self._model, camera.height, camera.width)
        self._model.camera("eye").fovy = math.degrees(2.0 * math.atan(camera.cy / camera.fy))
        # MuJoCo's cameras look along -z with y upwards, optical frames along z with y downwards.
        rotation = camera_to_scene.rotation @ np.diag([1.0, -1.0, -1.0])
        self._data.mocap_pos[0] = camera_to_scene.translation
        mujoco.mju_mat2Quat(self._data.mocap_quat[0], rotation.ravel())
        mujoco.mj_forward(self._model, self._data)
        self._renderer.update_scene(self._data, "eye")
        rgb = np.zeros((camera.height, camera.width, 3), np.uint8)
        if self.colours:
            rgb = self._renderer.render().copy()
        self._renderer.enable_depth_rendering()
        depth = self._renderer.render().copy()
        self._renderer.disable_depth_rendering()
        self._renderer.enable_segmentation_rendering()
        geoms = self._renderer.render()[..., 0]
        self._renderer.disable_segmentation_rendering()
        return RenderedView(rgb, np.where(geoms >= 0, depth, np.float32(0)), self._instances[geoms])

    def close(self) -> None:
        if self._renderer is not None:
            self._renderer.close()


def mujoco_world(config: HyPerNavConfig) -> SimulatedWorld:
    """The world of `--world mujoco_world:mujoco_world`."""
    model = room()
    scene = shapes(model)
    camera = MujocoCamera(model, scene)
    return SimulatedWorld(scene, config.world, config.embodiment, renderer=camera)


def main() -> None:
    config = hypernav.HyPerNavConfig()
    search = hypernav.find("chair", mujoco_world(config), config=config, seed=1)
    for step in search:
        print(f"{step.trace.step:3d}  {step.trace.reason}")
    print(search.result().outcome)


if __name__ == "__main__":
    main()
