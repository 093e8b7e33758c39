"""What a search publishes for people: map and its floor, path, markers for RViz, and an image."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from jaxtyping import UInt8

from hypernav.app.show.video_frame import draw_camera
from hypernav.core.geometry.grid import OccupancyGrid as Grid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import BlockRecord, StepTrace
from hypernav.robot.ros2.config import Ros2Config
from hypernav.robot.ros2.idl_types import (
    ColorRGBA,
    Header,
    Image,
    MapMetaData,
    Marker,
    MarkerArray,
    OccupancyGrid,
    Path,
    Point,
    Pose,
    PoseStamped,
    Quaternion,
    String,
    TFMessage,
    Time,
    Transform,
    TransformStamped,
    Vector3,
)
from hypernav.robot.ros2.network import Quality, Ros2Network
from hypernav.robot.wire.replies import StartInMemory
from hypernav.search.drawing import palette
from hypernav.search.mapping.ros_map import occupancy


def ros_time(seconds: float) -> Time:
    """A time as a message."""
    whole = math.floor(seconds)
    return Time(whole, int((seconds - whole) * 1e9))


def pose_message(pose: Pose2, header: Header) -> PoseStamped:
    """A pose on the floor."""
    rotation = Quaternion(z=math.sin(pose.yaw / 2.0), w=math.cos(pose.yaw / 2.0))
    return PoseStamped(header, Pose(Point(pose.x, pose.y), rotation))


_LINE_STRIP, _TEXT, _DELETE_ALL = 4, 9, 3
_LINE_M, _TEXT_M, _ABOVE_M = 0.04, 0.4, 0.05


class Ros2Outputs:
    """Publishes what the search knows and decides at every step."""

    def __init__(self, network: Ros2Network, config: Ros2Config) -> None:
        """Announce the topics, below ``topics.output``."""
        below = config.topics.output.rstrip("/")
        self._frame = config.frames.map or config.frames.odom
        self._memory_frame = f"{below.strip('/').replace('/', '_')}_map"
        self._frames = network.publisher(config.topics.tf_static, TFMessage, Quality.STATIC)
        self._map = network.publisher(f"{below}/map", OccupancyGrid, Quality.LATCHED)
        self._floor = network.publisher(f"{below}/floor", String, Quality.LATCHED)
        self._path = network.publisher(f"{below}/path", Path)
        self._markers = network.publisher(f"{below}/markers", MarkerArray)
        self._image = network.publisher(f"{below}/image", Image, Quality.LATCHED)
        self._start: StartInMemory | None = None
        self._blocks: list[BlockRecord] = []

    def publish(
        self,
        trace: StepTrace,
        grid: Grid,
        rgb: UInt8[np.ndarray, "height width 3"],
        *,
        at_s: float,
        camera_frame: str,
        start: StartInMemory | None = None,
    ) -> None:
        """Publish one step.

        Where the server has found the start, map, path and markers are in a frame of their own,
        whose pose is published as a static one.

        Args:
            trace: What the agent knew and decided.
            grid: The map of the floor that the robot is on.
            rgb: The camera image of the step.
            at_s: Time of the image, seconds.
            camera_frame: Frame of the image.
            start: Where the robot is in the server's memory; None if it knew.
        """
        header = Header(ros_time(at_s), self._frame)
        if start is not None:
            if start != self._start:
                self._frames.publish(frame_message(start, header, self._memory_frame))
            self._start = start
            header = Header(header.stamp, self._memory_frame)
        self._map.publish(grid_message(grid, header))
        self._floor.publish(String(f"floor {trace.floor or 1}"))
        self._path.publish(path_message(trace.path, header))
        self._blocks = trace.blocks or self._blocks
        self._markers.publish(marker_message(trace, self._blocks, header))
        height, width = rgb.shape[:2]
        drawn = draw_camera(rgb, trace.detections, width=width, height=height)
        self._image.publish(image_message(drawn, Header(header.stamp, camera_frame)))


def frame_message(start: StartInMemory, header: Header, name: str) -> TFMessage:
    """The pose of the search's ``map`` frame in that of the robot's poses, and its name."""
    map_to_robot = start.robot_to_map.inverse()
    x, y, z = map_to_robot.translation.tolist()
    half = map_to_robot.yaw / 2.0
    rotation = Quaternion(z=math.sin(half), w=math.cos(half))
    return TFMessage([TransformStamped(header, name, Transform(Vector3(x, y, z), rotation))])


def grid_message(grid: Grid, header: Header) -> OccupancyGrid:
    """The map: -1 unknown, 0 free, 100 occupied; its first cell is the lower left."""
    rows, columns = grid.cells.shape
    x, y = grid.origin
    origin = Pose(Point(float(x), float(y)))
    info = MapMetaData(header.stamp, float(grid.resolution_m), columns, rows, origin)
    return OccupancyGrid(header, info, occupancy(grid).tobytes())


def path_message(path: Sequence[tuple[float, float]], header: Header) -> Path:
    """A path; each corner looks to the next."""
    poses = []
    for (x, y), (ahead_x, ahead_y) in zip(path, [*path[1:], *path[-1:]], strict=True):
        yaw = math.atan2(ahead_y - y, ahead_x - x)
        if (ahead_x, ahead_y) == (x, y) and poses:
            poses.append(PoseStamped(header, Pose(Point(x, y), poses[-1].pose.orientation)))
        else:
            poses.append(pose_message(Pose2(x, y, yaw), header))
    return Path(header, poses)


def image_message(rgb: UInt8[np.ndarray, "height width 3"], header: Header) -> Image:
    """A colour image."""
    height, width = rgb.shape[:2]
    return Image(header, height, width, "rgb8", 0, 3 * width, rgb.tobytes())


def marker_message(trace: StepTrace, blocks: Sequence[BlockRecord], header: Header) -> MarkerArray:
    """Numbered blocks, the goal area and the destination; earlier markers are deleted.

    Args:
        trace: The step.
        blocks: Blocks of the last question about the map.
        header: Time and frame.
    """
    markers = [Marker(header, action=_DELETE_ALL)]
    for block in blocks:
        markers.append(_outline(header, "blocks", block.number, _corners(block), palette.BLOCK))
        middle = block.size_m / 2.0
        at = (block.x_min + middle, block.y_min + middle)
        markers.append(_text(header, "numbers", block.number, at, str(block.number)))
    for number, outline in enumerate(trace.goal_area):
        markers.append(_outline(header, "goal area", number, outline, palette.GOAL))
    if trace.destination is not None:
        markers.append(_text(header, "destination", 0, trace.destination, trace.mode.value))
    return MarkerArray(markers)


def _corners(block: BlockRecord) -> list[tuple[float, float]]:
    x, y, size = block.x_min, block.y_min, block.size_m
    return [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]


def _outline(
    header: Header,
    name: str,
    number: int,
    corners: Sequence[tuple[float, float]],
    color: palette.Rgb,
) -> Marker:
    closed: Iterable[tuple[float, float]] = [*corners, *corners[:1]]
    return Marker(
        header,
        ns=name,
        id=number,
        type=_LINE_STRIP,
        scale=Vector3(_LINE_M),
        color=_color(color),
        points=[Point(x, y, _ABOVE_M) for x, y in closed],
    )


def _text(header: Header, name: str, number: int, at: tuple[float, float], text: str) -> Marker:
    return Marker(
        header,
        ns=name,
        id=number,
        type=_TEXT,
        pose=Pose(Point(*at, _ABOVE_M)),
        scale=Vector3(z=_TEXT_M),
        color=_color(palette.ROBOT),
        text=text,
    )


def _color(color: palette.Rgb) -> ColorRGBA:
    return ColorRGBA(*(value / 255.0 for value in color), a=1.0)
