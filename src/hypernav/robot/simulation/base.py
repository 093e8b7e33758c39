"""The base of a simulated robot: wheels, odometry and camera in a scene, driven by velocities."""

import math
import time
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.embodiment import Embodiment
from hypernav.core.episode import Episode
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.depth import is_measured
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.core.observation import LabelledPixels
from hypernav.core.world import Position, RenderedView, Simulator
from hypernav.robot.client.robot import Sensed
from hypernav.robot.driving.base import DepthView, Velocity
from hypernav.robot.simulation.person import Person, PersonConfig, drawn_into
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.noise import noisy_depth

_SAFETY_PIXELS = (80, 60)
_EXPOSURE_S = 0.01
"""Time that an image takes, so that no two have the same time."""


class MishapConfig(RoomConfig):
    """What goes wrong with a simulated robot itself; nothing by default.

    Attributes:
        stuck_share: Share of the motions during which the wheels don't turn.
        person: A person who steps into the way; None for an empty building.
        localisation_error_m: Standard deviation of the robot's position in the ``map`` frame at
            every observation, metres: it jumps, but doesn't drift. None leaves the robot to its
            odometry.
    """

    stuck_share: float = Field(default=0.0, ge=0.0, lt=1.0)
    person: PersonConfig | None = None
    localisation_error_m: float | None = Field(default=None, ge=0.0, le=1.0)


@dataclass(frozen=True)
class _Errors:
    """Errors of wheels and odometry until the next observation, relative to the motion.

    Attributes:
        is_stuck: Whether the wheels don't turn.
        speed: Factor on the distance that is really driven.
        rotation: The same for the angle.
        along: Error of the odometry along the motion, per metre.
        aside: Its error to the left, per metre.
        yaw_per_m: Its error of the angle, radians per metre.
        yaw_per_rad: The same per radian.
    """

    is_stuck: bool = False
    speed: float = 1.0
    rotation: float = 1.0
    along: float = 0.0
    aside: float = 0.0
    yaw_per_m: float = 0.0
    yaw_per_rad: float = 0.0


class SimulatedBase:
    """A robot's base in a scene. Its clock runs while it drives and takes images.

    Attributes:
        world: The scene, and the truth about it.
        person: The person who steps into the way; None in an empty building.
        smallest_gap_m: Smallest distance so far between robot and person, metres; below 0 they
            have collided.
        path_length_m: Length of the path really driven, metres.
        odometry_length_m: The same by odometry.
        now_s: Time that has passed, seconds.
    """

    def __init__(
        self,
        world: Simulator,
        config: SimulationConfig,
        mishaps: MishapConfig | None = None,
        *,
        pace: float | None = None,
    ) -> None:
        """Create it in a world.

        Args:
            world: The scene.
            config: How the robot is simulated: the noise of its sensors and wheels.
            mishaps: What goes wrong.
            pace: Simulated seconds per real one while it drives; None runs as fast as it can.
        """
        self.world = world
        self.config = config
        self._mishaps = mishaps or MishapConfig()
        self._pace = pace
        camera = world.embodiment.camera
        self._coarse = PinholeCamera.from_hfov(*_SAFETY_PIXELS, camera.hfov_deg)
        self._labels = {i.id: i.label for i in world.truth.instances if i.label is not None}

    def place(self, episode: Episode, rng: np.random.Generator) -> None:
        """Put the robot at the start of an episode.

        Args:
            episode: Start, scene frame.
            rng: Generator of all that is random.
        """
        self.world.reset(episode, rng)
        self._rng = rng
        self._pose, self._position = self.world.truth.pose, self.world.truth.position
        self._map_to_scene = self.world.truth.map_to_scene
        self._odometry = self._odometry_in_map = Pose2(0.0, 0.0, 0.0)
        self._errors = self._drawn_errors()
        person = self._mishaps.person
        self.person = None if person is None else Person(person, self.world.truth.walkable, rng)
        self.smallest_gap_m = math.inf
        self.path_length_m = self.odometry_length_m = self.now_s = 0.0

    def localise(self) -> None:
        """From now on give poses in the scene frame, instead of one that begins at the start.

        So they are in one frame in every search, as those of a robot that knows where it is in a
        map that lasts.
        """
        start = self.world.truth.map_to_scene
        x, y, _ = start.translation.tolist()
        self._map_to_scene, self._odometry_in_map = Transform.identity(), Pose2(x, y, start.yaw)

    @property
    def embodiment(self) -> Embodiment:
        """Body, camera, and effect of the actions."""
        return self.world.embodiment

    @property
    def position(self) -> Position:
        """True position ``(x, y, z)``, scene frame, metres."""
        return self._position

    @property
    def pose(self) -> Pose2:
        """True pose, scene frame."""
        return self._pose

    def odometry(self) -> Pose2:
        """Pose in the frame of the odometry, which begins at the start."""
        return self._odometry

    def sense(self) -> Sensed:
        """Images and pose, taken now."""
        self._errors = self._drawn_errors()
        self.now_s += _EXPOSURE_S
        view = self._view(self.embodiment.camera.intrinsics)
        labels = LabelledPixels(view.instance_ids, self._labels)
        height_m = self._position[2] - float(self._map_to_scene.translation[2])
        return Sensed(
            rgb=view.rgb,
            depth=self._measured(view),
            odometry=self._odometry,
            stamp_s=self.now_s,
            odom_to_map=self._odom_to_map(),
            height_m=height_m,
            truth=labels if self.config.labels else None,
        )

    def depth_view(self) -> DepthView:
        """A coarse depth image."""
        depth = self._measured(self._view(self._coarse, colours=False))
        to_base = self.embodiment.camera.camera_to_base
        return DepthView(depth, self._coarse, to_base, self.now_s, self._odometry)

    def drive(self, velocity: Velocity, seconds: float) -> None:
        """Drive with a velocity, and move the person."""
        if self._pace is not None:
            time.sleep(seconds / self._pace)
        if not self._errors.is_stuck and not velocity.is_zero:
            self._move(velocity, seconds)
        self.now_s += seconds
        if self.person is not None:
            radius_m = self.embodiment.body.radius_m
            drives = velocity.linear_m_s > 0.0
            self.person.live(seconds, self._pose, self._position[2], radius_m, drives=drives)
            gap_m = self.person.gap_m(self._position, radius_m)
            self.smallest_gap_m = min(self.smallest_gap_m, gap_m)

    def halt(self) -> None:
        """Do nothing: the simulated wheels stand when nobody drives them."""

    def _move(self, velocity: Velocity, seconds: float) -> None:
        errors, before = self._errors, self._pose
        real = Velocity(
            velocity.linear_m_s * errors.speed, velocity.angular_rad_s * errors.rotation
        )
        wanted = real.moved(before, seconds)
        x, y, z = self.world.truth.walkable.move(
            self._position, wanted.x - before.x, wanted.y - before.y
        )
        self._pose = Pose2(x, y, wanted.yaw)
        length_m = math.dist(self._position[:2], (x, y))
        self._position = (x, y, z)
        turned = real.angular_rad_s * seconds
        told_m, beside_m = length_m * (1.0 + errors.along), length_m * errors.aside
        yaw, heading = self._odometry.yaw, self._odometry.yaw + turned / 2.0
        c, s = math.cos(heading), math.sin(heading)
        after = Pose2(
            self._odometry.x + c * told_m - s * beside_m,
            self._odometry.y + s * told_m + c * beside_m,
            wrap_angle(
                yaw + turned + errors.yaw_per_m * length_m + errors.yaw_per_rad * abs(turned)
            ),
        )
        self.path_length_m += length_m
        self.odometry_length_m += self._odometry.distance_to(*after.xy)
        self._odometry = after

    def _drawn_errors(self) -> _Errors:
        noise, motion, rng = self.config.noise, self.embodiment.motion, self._rng
        is_stuck = bool(rng.random() < self._mishaps.stuck_share)
        speed, rotation, along, aside, yaw = rng.standard_normal(5).tolist()
        yaw_rad = math.radians(noise.odometry_turn_sigma_deg) * yaw
        return _Errors(
            is_stuck=is_stuck,
            speed=max(1.0 + noise.forward_sigma * speed, 0.0),
            rotation=max(1.0 + noise.turn_sigma_deg / motion.turn_angle_deg * rotation, 0.0),
            along=noise.odometry_sigma * along,
            aside=noise.odometry_sigma * aside,
            yaw_per_m=yaw_rad / motion.forward_m,
            yaw_per_rad=yaw_rad / math.radians(motion.turn_angle_deg),
        )

    def _odom_to_map(self) -> Pose2:
        """The pose of the odometry frame by localisation, with its errors."""
        error_m = self._mishaps.localisation_error_m
        if error_m is None:
            return self._odometry_in_map
        floor = self._pose.to_transform(self._position[2])
        base_to_map = self._map_to_scene.inverse() @ floor
        dx, dy = (error_m * self._rng.standard_normal(2)).tolist()
        found = base_to_map @ self._odometry.to_transform().inverse()
        x, y, _ = found.translation
        return Pose2(float(x + dx), float(y + dy), found.yaw)

    def _view(self, camera: PinholeCamera, *, colours: bool = True) -> RenderedView:
        base_to_scene = self._pose.to_transform(self._position[2])
        pose = base_to_scene @ self.embodiment.camera.camera_to_base
        view = self.world.truth.view_from(pose, camera, colours=colours)
        if self.person is None:
            return view
        return drawn_into(view, camera, pose, self.person, self._position[2])

    def _measured(self, view: RenderedView) -> Float32[np.ndarray, "height width"]:
        """Depth as the sensor measures it, also where it is too inexact for the map."""
        depth = noisy_depth(view.depth, self.config.noise, self._rng)
        measured = is_measured(depth, self.embodiment.camera.min_depth_m)
        return np.where(measured, depth, np.float32(0.0))
