"""Observation, map and trace of a step as Foxglove's own messages.

Frames: ``map``, ``base_link`` (the robot on the floor) and ``camera`` (optical: x right, y down, z
forward), see docs/conventions.md.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from foxglove import messages as fg
from scipy.spatial.transform import Rotation

from hypernav.app.show import captions
from hypernav.app.show.viewers.frame_data import Line, at_height, cloud, colour_jpeg, map_colors
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import DetectionRecord, Exchange, StepTrace
from hypernav.search.drawing import palette

MAP, BASE, CAMERA = "map", "base_link", "camera"

_RGBA = ("red", "green", "blue", "alpha")
_FLOAT, _BYTE = fg.PackedElementFieldNumericType.Float32, fg.PackedElementFieldNumericType.Uint8
_POINT = np.dtype([("xyz", "<f4", 3), ("rgba", "u1", 4)])
_LINE_M = 0.04
_DESTINATION_M = 0.25

_UNTURNED = fg.Quaternion(w=1.0)
_AT_ORIGIN = fg.Pose(position=fg.Vector3(), orientation=_UNTURNED)

# Foxglove reads fields of plain types: no references, no alternatives, no arrays of arrays.
_TEXT, _NUMBER, _COUNT, _FLAG = (
    {"type": kind} for kind in ("string", "number", "integer", "boolean")
)


def transforms(stamp: fg.Timestamp, observation: Observation, z: float) -> fg.FrameTransforms:
    """The robot on the map, at its height, and the camera on the robot."""
    base_to_map = observation.robot.to_transform(z)
    camera_to_base = base_to_map.inverse() @ observation.camera_to_map
    return fg.FrameTransforms(
        transforms=[
            _transform(stamp, MAP, BASE, base_to_map),
            _transform(stamp, BASE, CAMERA, camera_to_base),
        ]
    )


def robot_pose(stamp: fg.Timestamp, step: StepTrace) -> fg.PoseInFrame:
    """The robot's pose in the map."""
    x, y, yaw = step.pose
    orientation = _quaternion(Rotation.from_euler("z", yaw))
    pose = fg.Pose(position=fg.Vector3(x=x, y=y, z=step.z), orientation=orientation)
    return fg.PoseInFrame(timestamp=stamp, frame_id=MAP, pose=pose)


def image(stamp: fg.Timestamp, observation: Observation) -> fg.CompressedImage:
    """The colour image."""
    data = colour_jpeg(observation)
    return fg.CompressedImage(timestamp=stamp, frame_id=CAMERA, data=data, format="jpeg")


def calibration(stamp: fg.Timestamp, camera: PinholeCamera) -> fg.CameraCalibration:
    """The intrinsics of the camera. Here the centre of the first pixel is at 0, not at 0.5."""
    cx, cy = camera.cx - 0.5, camera.cy - 0.5
    return fg.CameraCalibration(
        timestamp=stamp,
        frame_id=CAMERA,
        width=camera.width,
        height=camera.height,
        K=[camera.fx, 0.0, cx, 0.0, camera.fy, cy, 0.0, 0.0, 1.0],
        P=[camera.fx, 0.0, cx, 0.0, 0.0, camera.fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def annotations(stamp: fg.Timestamp, detections: Sequence[DetectionRecord]) -> fg.ImageAnnotations:
    """Boxes, outlines and labels over the colour image; green is accepted."""
    lines, texts = [], []
    for one in detections:
        left, top, right, bottom = one.box
        color = _color(palette.GOAL if one.accepted else palette.CHOSEN)
        box = [(left, top), (right, top), (right, bottom), (left, bottom)]
        for outline in (box, *one.outlines):
            lines.append(
                fg.PointsAnnotation(
                    timestamp=stamp,
                    type=fg.PointsAnnotationType.LineLoop,
                    points=[fg.Point2(x=x, y=y) for x, y in outline],
                    outline_color=color,
                    thickness=2.0,
                )
            )
        texts.append(
            fg.TextAnnotation(
                timestamp=stamp,
                position=fg.Point2(x=left, y=top),
                text=captions.detections_caption([one]),
                font_size=14.0,
                text_color=_color(palette.PAPER),
                background_color=color,
            )
        )
    return fg.ImageAnnotations(timestamp=stamp, points=lines, texts=texts)


def point_cloud(stamp: fg.Timestamp, observation: Observation) -> fg.PointCloud:
    """The thinned depth image as coloured points in the map."""
    points, colors = cloud(observation)
    packed = np.empty(len(points), dtype=_POINT)
    packed["xyz"], packed["rgba"][:, :3], packed["rgba"][:, 3] = points, colors, 255
    fields = [
        fg.PackedElementField(name=name, offset=4 * n, type=_FLOAT) for n, name in enumerate("xyz")
    ]
    return fg.PointCloud(
        timestamp=stamp,
        frame_id=MAP,
        pose=_AT_ORIGIN,
        point_stride=_POINT.itemsize,
        fields=[*fields, *_rgba_fields(12)],
        data=packed.tobytes(),
    )


def map_grid(stamp: fg.Timestamp, grid: OccupancyGrid, floor_m: float) -> fg.Grid:
    """The explored part of the map, at a floor's height; what is unknown is transparent."""
    seen = grid.cropped()
    columns = seen.cells.shape[1]
    x, y = seen.origin
    return fg.Grid(
        timestamp=stamp,
        frame_id=MAP,
        pose=fg.Pose(position=fg.Vector3(x=x, y=y, z=floor_m), orientation=_UNTURNED),
        column_count=columns,
        cell_size=fg.Vector2(x=seen.resolution_m, y=seen.resolution_m),
        row_stride=4 * columns,
        cell_stride=4,
        fields=_rgba_fields(0),
        data=map_colors(seen).tobytes(),
    )


def scene(
    stamp: fg.Timestamp,
    step: StepTrace,
    trajectory: Line,
    asked: StepTrace | None,
    floor_m: float,
) -> fg.SceneUpdate:
    """Trajectory, path, destination, goal area and blocks, as entities that replace the last ones.

    Args:
        stamp: Time of the step.
        step: Trace of the step.
        trajectory: Positions of the robot up to now, metres.
        asked: Step in which the robot was sent to its present block; None if there is none.
        floor_m: Height of the floor.
    """
    path = at_height([step.pose[:2], *step.path] if step.path else [], step.z)
    marks = at_height([] if step.destination is None else [step.destination], step.z)
    area = [at_height(outline, floor_m) for outline in step.goal_area]

    def entity(name: str, **primitives: Any) -> fg.SceneEntity:
        return fg.SceneEntity(timestamp=stamp, frame_id=MAP, id=name, **primitives)

    return fg.SceneUpdate(
        entities=[
            entity("trajectory", lines=_lines([trajectory], palette.TRAJECTORY_NEW, 0.02)),
            entity("path", lines=_lines([path], palette.PATH, 0.03)),
            entity("destination", spheres=[_mark(*one) for one in marks]),
            entity("goal area", lines=_lines(area, palette.GOAL, 0.04, closed=True)),
            _blocks(entity, asked, floor_m),
        ]
    )


def log(stamp: fg.Timestamp, step: StepTrace) -> list[fg.Log]:
    """What the robot does and why, and the events of the step."""
    reason = f"{captions.floor_prefix(step)}{captions.MODES[step.mode]}: {step.reason}"
    return [
        fg.Log(timestamp=stamp, level=fg.LogLevel.Info, message=message, name=f"step {step.step}")
        for message in (reason, *step.events)
    ]


def _blocks(entity: Any, asked: StepTrace | None, floor_m: float) -> fg.SceneEntity:
    """The numbered blocks of the last question about the map, the chosen one filled."""
    if asked is None:
        return entity("blocks")
    chosen = [one.chosen for one in asked.exchanges if one.chosen is not None]
    lines, cubes, texts = [], [], []
    for block in asked.blocks:
        left, bottom, side = block.x_min, block.y_min, block.size_m
        right, top = left + side, bottom + side
        square = at_height([(left, bottom), (right, bottom), (right, top), (left, top)], floor_m)
        lines += _lines([square], palette.BLOCK, 0.02, closed=True)
        middle = fg.Pose(
            position=fg.Vector3(x=left + side / 2, y=bottom + side / 2, z=floor_m + 0.01),
            orientation=_UNTURNED,
        )
        if chosen and block.number == chosen[-1]:
            size = fg.Vector3(x=side, y=side, z=0.01)
            cubes.append(
                fg.CubePrimitive(pose=middle, size=size, color=_color(palette.CHOSEN, 0.4))
            )
        texts.append(
            fg.TextPrimitive(
                pose=middle,
                billboard=True,
                font_size=0.4,
                color=_color(palette.INK),
                text=str(block.number),
            )
        )
    return entity("blocks", lines=lines, cubes=cubes, texts=texts)


def _lines(
    strips: Sequence[Line],
    color: palette.Rgb,
    height_m: float,
    *,
    closed: bool = False,
) -> list[fg.LinePrimitive]:
    """Lines so far above their points; those of a single point are left out."""
    kind = fg.LinePrimitiveLineType.LineLoop if closed else fg.LinePrimitiveLineType.LineStrip
    return [
        fg.LinePrimitive(
            type=kind,
            pose=_AT_ORIGIN,
            thickness=_LINE_M,
            points=[fg.Point3(x=x, y=y, z=z + height_m) for x, y, z in strip],
            color=_color(color),
        )
        for strip in strips
        if len(strip) > 1
    ]


def _mark(x: float, y: float, z: float) -> fg.SpherePrimitive:
    size = fg.Vector3(x=_DESTINATION_M, y=_DESTINATION_M, z=_DESTINATION_M)
    pose = fg.Pose(position=fg.Vector3(x=x, y=y, z=z), orientation=_UNTURNED)
    return fg.SpherePrimitive(pose=pose, size=size, color=_color(palette.PATH))


def _transform(
    stamp: fg.Timestamp, parent: str, child: str, child_to_parent: Transform
) -> fg.FrameTransform:
    x, y, z = child_to_parent.translation.tolist()
    return fg.FrameTransform(
        timestamp=stamp,
        parent_frame_id=parent,
        child_frame_id=child,
        translation=fg.Vector3(x=x, y=y, z=z),
        rotation=_quaternion(Rotation.from_matrix(child_to_parent.rotation)),
    )


def _quaternion(rotation: Rotation) -> fg.Quaternion:
    x, y, z, w = rotation.as_quat().tolist()
    return fg.Quaternion(x=x, y=y, z=z, w=w)


def _color(color: palette.Rgb, opacity: float = 1.0) -> fg.Color:
    red, green, blue = (value / 255.0 for value in color)
    return fg.Color(r=red, g=green, b=blue, a=opacity)


def _rgba_fields(offset: int) -> list[fg.PackedElementField]:
    return [
        fg.PackedElementField(name=name, offset=offset + n, type=_BYTE)
        for n, name in enumerate(_RGBA)
    ]


def _schema(title: str, fields: dict[str, Any]) -> dict[str, Any]:
    return {"title": title, "type": "object", "properties": fields}


STEP_SCHEMA = _schema(
    "hypernav.Step",
    {
        "step": _COUNT,
        "mode": _TEXT,
        "reason": _TEXT,
        "action": _TEXT,
        "ending": _TEXT,
        "seconds": _NUMBER,
        "events": {"type": "array", "items": _TEXT},
        "detections": {
            "type": "array",
            "items": _schema(
                "detection",
                {"label": _TEXT, "score": _NUMBER, "accepted": _FLAG, "reason": _TEXT},
            ),
        },
    },
)
QUESTION_SCHEMA = _schema(
    "hypernav.Question",
    {
        "step": _COUNT,
        "kind": _TEXT,
        "asked": _TEXT,
        "question": _TEXT,
        "answer": _TEXT,
        "fault": _TEXT,
        "tokens_in": _COUNT,
        "tokens_out": _COUNT,
        "seconds": _NUMBER,
    },
)


def step_fields(step: StepTrace) -> dict[str, Any]:
    """The step as a message of `STEP_SCHEMA`."""
    return {
        "step": step.step,
        "mode": step.mode.value,
        "reason": step.reason,
        "action": "" if step.action is None else step.action.name.lower().replace("_", " "),
        "ending": "" if step.ending is None else step.ending.value,
        "seconds": sum(step.seconds.values()),
        "events": step.events,
        "detections": [
            one.model_dump(include={"label", "score", "accepted", "reason"})
            for one in step.detections
        ],
    }


def question_fields(number: int, exchange: Exchange) -> dict[str, Any]:
    """A question and its answer as a message of `QUESTION_SCHEMA`."""
    kept = QUESTION_SCHEMA["properties"].keys() - {"step"}
    return {"step": number, **exchange.model_dump(include=kept)}
