"""A simulated robot in a scene: takes actions, gives observations."""

import math

import numpy as np
from jaxtyping import Float32

from hypernav.core.components.abilities import Closes
from hypernav.core.embodiment import Action, Embodiment
from hypernav.core.episode import Episode
from hypernav.core.errors import WorldError
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.core.world import Instance, Position, RenderedView, Renderer
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.drawing.renderer import renderer_of
from hypernav.simulator.worlds.goal_objects import named_as_goals
from hypernav.simulator.worlds.noise import noisy_depth
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.simulated_robot import SimulatedRobot, check_standable
from hypernav.simulator.worlds.surface.walkable_surface import WalkableSurface
from hypernav.simulator.worlds.survey import SurveyedScene


class SimulatedWorld(SurveyedScene):
    """A robot in a scene: a `World`, and the `SceneTruth` of that scene.

    Poses and positions of this class are ground truth in the scene frame. Observations are in the
    ``map`` frame, which starts at the start pose (x forward, y left, z up from the floor) unless
    it is kept, with the robot's pose as odometry reports it.
    """

    def __init__(
        self,
        scene: Scene,
        config: SimulationConfig | None = None,
        embodiment: Embodiment | None = None,
        *,
        renderer: Renderer | None = None,
        walkable: WalkableSurface | None = None,
    ) -> None:
        """Open a scene for a robot; `reset` places the robot.

        Args:
            scene: The scene that the robot is in.
            config: How the robot is simulated.
            embodiment: Body, camera and motion of the robot; by default the preset ``default``'s.
            renderer: Renderer of the scene; by default the one that the configuration names.
            walkable: The surface on which the robot can stand; by default the navigation
                mesh that the configuration names, or computed from the scene where it has none.

        Raises:
            SceneError: The robot fits nowhere, or the navigation mesh can't be read or computed.
            MissingExtraError: Embree is not installed, or what the renderer needs.
        """
        config = config or SimulationConfig()
        self._renderer = renderer or renderer_of(scene, config.renderer)
        # A renderer may have a ray caster of the scene, so that no second one is built.
        rays = getattr(self._renderer, "rays", None)
        super().__init__(scene, config, embodiment, rays=rays, walkable=walkable)
        self._camera = self.embodiment.camera.intrinsics
        self._tilt_deg = 0.0
        self._instances = scene.instances
        self._labels: dict[int, ObjectLabel] = {}
        # never used if all noise is off
        self._rng = np.random.default_rng(0)
        self._robot = self._robot_at(Pose2(0.0, 0.0, 0.0), math.nan)
        self._map_frame: Transform | None = None
        self._start: Transform | None = None
        self._observation: Observation | None = None
        self._stopped = False

    def close(self) -> None:
        """Close the renderer, if it holds threads; the world is not used afterwards."""
        if isinstance(self._renderer, Closes):
            self._renderer.close()

    def keep_map_frame(self, map_to_scene: Transform | None) -> None:
        """Give all later observations in one ``map`` frame, wherever their episodes start.

        So does a localised robot, whose map outlasts a search. The pose at the start is exact.

        Args:
            map_to_scene: The frame, upright, such as the `map_to_scene` of an earlier episode; None
                begins one at every start again.
        """
        self._map_frame = map_to_scene

    def reset(self, episode: Episode, rng: np.random.Generator | None = None) -> Observation:
        """Place the robot at the start of an episode.

        Args:
            episode: An episode in this scene.
            rng: Generator of all noise; needed only if noise is switched on.

        Returns:
            The first observation; its robot pose is the origin of the ``map`` frame, unless that
            is kept (`keep_map_frame`).

        Raises:
            SceneError: There is no storey at the height of the start.
            StartError: The robot can't stand at the start.
            WorldError: Noise is switched on and there is no generator for it.
        """
        if not self.config.noise.is_off and rng is None:
            raise WorldError("noise is switched on; pass reset a numpy.random.Generator for it")
        self.enter_storey(episode.start_z)
        check_standable(self.walkable, episode.start, episode.start_z)
        floor_z = self.walkable.height_at(*episode.start.xy, episode.start_z)
        self._rng = rng if rng is not None else np.random.default_rng(0)
        self._robot = self._robot_at(episode.start, floor_z)
        start = episode.start.to_transform(self._robot.floor_z)
        self._start = start if self._map_frame is None else self._map_frame
        if self._map_frame is not None:
            in_map = self._map_frame.inverse() @ start
            x, y, _ = in_map.translation.tolist()
            self._robot.reported = Pose2(x, y, in_map.yaw)
        return self._begin(episode)

    def _begin(self, episode: Episode) -> Observation:
        """The first look for an episode's goal."""
        self._stopped = False
        self._tilt_deg = 0.0
        self._instances = named_as_goals(self.scene.instances, episode)
        self._labels = {i.id: i.label for i in self._instances if i.label is not None}
        self._observation = self._look()
        return self._observation

    def go_on(self, episode: Episode) -> Observation:
        """Begin a further episode of a life: the robot stays, and so do its map frame and noise.

        Args:
            episode: An episode in this scene; its start is ignored.

        Returns:
            The first observation.

        Raises:
            WorldError: Before the first `reset`.
        """
        if self._observation is None:
            raise WorldError("no robot stands here before reset: place it first")
        return self._begin(episode)

    def step(self, action: Action) -> Observation:
        """Take an action and observe.

        STOP ends the episode and returns the latest observation again.

        Raises:
            WorldError: Before the first `reset`, or after STOP.
        """
        self._check_running()
        if action == Action.STOP:
            self._stopped = True
            return self.observation
        self._robot.move(action)
        self._observation = self._look()
        return self._observation

    def tilt(self, angle_deg: float) -> Observation:
        """Tilt the camera and observe; `reset` turns it back.

        Args:
            angle_deg: Angle by which it looks further down, degrees; negative looks up.

        Raises:
            WorldError: Before the first `reset`, or after STOP.
        """
        self._check_running()
        self._tilt_deg += angle_deg
        self._observation = self._look()
        return self._observation

    @property
    def observation(self) -> Observation:
        """The latest observation.

        Raises:
            WorldError: Before the first `reset`.
        """
        if self._observation is None:
            raise WorldError("no observation before reset: place the robot first")
        return self._observation

    @property
    def pose(self) -> Pose2:
        """True pose of the robot, scene frame."""
        return self._robot.pose

    @property
    def position(self) -> Position:
        """True position of the robot on the floor, ``(x, y, z)``, scene frame, metres."""
        return self._robot.position

    @property
    def is_over(self) -> bool:
        """Whether the robot has taken STOP."""
        return self._stopped

    @property
    def collided(self) -> bool:
        """Whether an obstacle stopped the latest action."""
        return self._robot.collided and not self._stopped

    @property
    def path_length_m(self) -> float:
        """Sum of the true displacements in space since the reset, as in Habitat."""
        return self._robot.path_length_m

    @property
    def map_to_scene(self) -> Transform:
        """Transform from the ``map`` frame of this episode to the scene frame.

        Raises:
            WorldError: Before the first `reset`.
        """
        if self._start is None:
            raise WorldError("the map frame starts at the start pose; place the robot first")
        return self._start

    @property
    def camera_to_scene(self) -> Transform:
        """True pose of the camera, scene frame."""
        robot = self._robot
        return robot.pose.to_transform(robot.floor_z) @ self._camera_to_base

    @property
    def colours(self) -> bool:
        """Whether observations have colours; without, their images are black, which is faster."""
        return self._renderer.colours

    @colours.setter
    def colours(self, wanted: bool) -> None:
        self._renderer.colours = wanted

    def view_from(
        self,
        camera_to_scene: Transform,
        camera: PinholeCamera | None = None,
        *,
        colours: bool = True,
    ) -> RenderedView:
        """What a camera sees from a given pose, scene frame, without noise.

        Args:
            camera_to_scene: Pose of the optical frame.
            camera: Intrinsics; None takes the robot's.
            colours: Whether the image is drawn; without, it is black.
        """
        as_before, self.colours = self.colours, colours
        try:
            return self._renderer.render(camera or self._camera, camera_to_scene)
        finally:
            self.colours = as_before

    @property
    def instances(self) -> tuple[Instance, ...]:
        """All instances of the scene; an instance's id is its index.

        Those that the episode names as goals have its goal as a further name.
        """
        return self._instances

    @property
    def truth(self) -> "SimulatedWorld":
        """The ground truth of the scene, which a simulated world always has."""
        return self

    @property
    def _camera_to_base(self) -> Transform:
        camera = self.embodiment.camera
        return optical_to_base(camera.height_m, camera.pitch_deg + self._tilt_deg)

    def _check_running(self) -> None:
        if self._observation is None:
            raise WorldError("step before reset: place the robot first")
        if self._stopped:
            raise WorldError("step after STOP: the episode is over, reset the world")

    def _robot_at(self, start: Pose2, floor_z: float) -> SimulatedRobot:
        return SimulatedRobot(
            self.walkable,
            start,
            floor_z,
            motion=self.embodiment.motion,
            noise=self.config.noise,
            sliding=self.config.sliding,
            rng=self._rng,
        )

    def _look(self) -> Observation:
        view = self._renderer.render(self._camera, self.camera_to_scene)
        robot = self._robot
        above_start = robot.floor_z - float(self.map_to_scene.translation[2])
        truth = LabelledPixels(view.instance_ids, self._labels) if self.config.labels else None
        return Observation(
            rgb=view.rgb,
            depth=self._sensed(view),
            camera=self._camera,
            camera_to_map=robot.reported.to_transform(above_start) @ self._camera_to_base,
            robot=robot.reported,
            truth=truth,
        )

    def _sensed(self, view: RenderedView) -> Float32[np.ndarray, "height width"]:
        """Depth as the sensor measures it: with noise, and 0 outside its range."""
        camera, noise = self.embodiment.camera, self.config.noise
        depth = view.depth
        if noise.depth_sigma_m > 0.0 or noise.depth_edge_px > 0:
            depth = noisy_depth(depth, noise, self._rng)
        measured = is_measured(depth, camera.min_depth_m, camera.max_depth_m)
        return np.where(measured, depth, np.float32(0.0))
