"""Observation, map and trace of a step as archetypes of rerun, in the ``map`` frame (z up)."""

from collections.abc import Sequence

import rerun as rr
from rerun import blueprint as rrb
from scipy.spatial.transform import Rotation

from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import DetectionRecord, Exchange, StepTrace
from hypernav.show import captions
from hypernav.show.drawing import palette
from hypernav.show.views.frame_data import Line, at_height, cloud, colour_jpeg, map_colors

TIMELINE = "step"

_LINE_M, _POINT_M, _MARK_M, _ARROW_M = 0.02, 0.015, 0.12, 0.5
_FRUSTUM_M = 0.4
_STEPS_PER_SECOND = 5.0
_SEE_THROUGH = 0.999
"""Opacity of the map: at 1 its transparent cells would be black."""

HEADING = rr.Arrows3D(vectors=[[_ARROW_M, 0.0, 0.0]], colors=[palette.ROBOT], radii=[0.04])
"""An arrow ahead, in the frame of the robot."""


def layout() -> rrb.Blueprint:
    """A layout of the viewer: building and map beside camera image, last answer and log.

    The points of all steps so far are shown together, so that the building grows.
    """
    since_start = rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.infinite(),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Spatial3DView(
                    origin="map", name="Building", overrides={"map/points": [since_start]}
                ),
                rrb.Spatial3DView(
                    origin="map",
                    name="Map",
                    contents=["$origin/**", "- $origin/points", "- $origin/camera/**"],
                    background=[*palette.UNKNOWN_STRONG, 255],
                    line_grid=False,
                ),
            ),
            rrb.Vertical(
                rrb.Spatial2DView(origin="map/camera/image", name="Camera"),
                rrb.TextDocumentView(origin="answer", name="Last answer"),
                rrb.TextLogView(origin="log", name="Log"),
                row_shares=[3, 2, 2],
            ),
            column_shares=[3, 2],
        ),
        rrb.TimePanel(timeline=TIMELINE, fps=_STEPS_PER_SECOND, state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
    )


def transform(child_to_parent: Transform) -> rr.Transform3D:
    """A pose in its parent's frame."""
    quaternion = Rotation.from_matrix(child_to_parent.rotation).as_quat()
    return rr.Transform3D(
        translation=child_to_parent.translation, quaternion=rr.Quaternion(xyzw=quaternion)
    )


def cells(grid: OccupancyGrid, floor_m: float) -> rr.GridMap:
    """The explored part of the map, as an image with its first row on top, at a floor's height."""
    seen = grid.cropped()
    rows, columns = seen.cells.shape
    return rr.GridMap(
        data=map_colors(seen)[::-1].tobytes(),
        format=rr.components.ImageFormat(
            width=columns, height=rows, color_model="RGBA", channel_datatype="U8"
        ),
        cell_size=seen.resolution_m,
        translation=[*seen.origin, floor_m],
        opacity=_SEE_THROUGH,
    )


def lines(strips: Sequence[Line], color: palette.Rgb) -> rr.LineStrips3D:
    """Lines just above their points; those of a single point are left out."""
    lifted = [[(x, y, z + _LINE_M) for x, y, z in strip] for strip in strips if len(strip) > 1]
    return rr.LineStrips3D(lifted, colors=[color] * len(lifted), radii=_LINE_M)


def blocks(step: StepTrace, floor_m: float) -> rr.LineStrips3D:
    """The numbered blocks of a question, at a floor's height; the chosen one stands out."""
    chosen = [one.chosen for one in step.exchanges if one.chosen is not None]
    squares, colors = [], []
    for block in step.blocks:
        left, bottom, side = block.x_min, block.y_min, block.size_m
        corners = ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))
        square = [(left + x * side, bottom + y * side) for x, y in corners]
        squares.append(at_height(square, floor_m + _LINE_M))
        is_chosen = bool(chosen) and block.number == chosen[-1]
        colors.append(palette.CHOSEN if is_chosen else palette.FAINT)
    labels = [str(block.number) for block in step.blocks]
    return rr.LineStrips3D(squares, colors=colors, labels=labels, radii=_LINE_M)


def pinhole(camera: PinholeCamera) -> rr.Pinhole:
    """The intrinsics of the camera."""
    return rr.Pinhole(
        focal_length=(camera.fx, camera.fy),
        principal_point=(camera.cx, camera.cy),
        resolution=(camera.width, camera.height),
        image_plane_distance=_FRUSTUM_M,
    )


def image(observation: Observation) -> rr.EncodedImage:
    """The colour image."""
    return rr.EncodedImage(contents=colour_jpeg(observation), media_type="image/jpeg")


def points(observation: Observation) -> rr.Points3D:
    """The thinned depth image as coloured points in the map."""
    positions, colors = cloud(observation)
    return rr.Points3D(positions, colors=colors, radii=_POINT_M)


def masks(detections: Sequence[DetectionRecord]) -> rr.LineStrips2D:
    """Outlines of the refined masks over the colour image."""
    outlines = [(line, _color(one)) for one in detections for line in one.outlines]
    return rr.LineStrips2D(
        [[*line, line[0]] for line, _ in outlines], colors=[color for _, color in outlines]
    )


def boxes(detections: Sequence[DetectionRecord]) -> rr.Boxes2D:
    """Boxes and labels over the colour image; green is accepted."""
    return rr.Boxes2D(
        array=[one.box for one in detections],
        array_format=rr.Box2DFormat.XYXY,
        labels=[captions.detections_caption([one]) for one in detections],
        colors=[_color(one) for one in detections],
    )


def _color(detection: DetectionRecord) -> palette.Rgb:
    return palette.GOAL if detection.accepted else palette.CHOSEN


def _words(step: int, exchange: Exchange) -> str:
    asked = captions.answerer_caption(exchange)
    return (
        f"## {captions.question_caption(exchange)}\n\n{exchange.answer}\n\n"
        f"*Step {step}, {asked}*\n\n> {captions.final_question(exchange.question)}"
    )


def destination(step: StepTrace) -> rr.Points3D:
    """Where the robot is going, if anywhere."""
    marks = [] if step.destination is None else [(*step.destination, step.z + _LINE_M)]
    return rr.Points3D(marks, colors=[palette.PATH] * len(marks), radii=_MARK_M)


def answers(step: StepTrace) -> rr.TextDocument:
    """The questions of a step and their answers."""
    return document("\n\n".join(_words(step.step, one) for one in step.exchanges))


def document(text: str) -> rr.TextDocument:
    """A text in Markdown."""
    return rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN)
