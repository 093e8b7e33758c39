"""The data of a walk through a building, for the page's script."""

import base64
import math
from collections.abc import Callable
from typing import Any

from hypernav.core.geometry.transforms import wrap_angle
from hypernav.houses.export.panorama import SLICES, Panorama, Sighting, draw_panorama, half_slope
from hypernav.houses.export.walk_graph import WalkGraph
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.worlds.drawing.renderer import CpuRenderer
from hypernav.worlds.scenes.scene import Scene
from hypernav.worlds.surface.walkable import WalkableGrid

_TURN_DEG = 30
_AHEAD = math.radians(40.0)


def walk_data(
    scene: Scene,
    plan: FloorPlan,
    graph: WalkGraph,
    *,
    grid: WalkableGrid,
    renderer: CpuRenderer,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """Positions, with the visible objects and the panorama of each.

    Args:
        scene: Scene of the building.
        plan: Floor plan of the building.
        graph: Positions and drives of the walk.
        grid: Where the robot can stand.
        renderer: Renderer of the scene.
        progress: Function that is called with the numbers of drawn panoramas and of all.

    Returns:
        Plain data for JSON. Angles are degrees, counter-clockwise from the x axis; distances are
        tenths of a metre.
    """
    labels = {i.id: i.label for i in scene.instances if i.label is not None}
    names = sorted({label.category for label in labels.values()})
    index = {name: n for n, name in enumerate(names)}
    positions, panoramas, sights = [], [], list[list[Sighting]]()
    for number, (point, neighbours) in enumerate(
        zip(graph.positions, graph.neighbours, strict=True), start=1
    ):
        panorama = draw_panorama(point, grid=grid, renderer=renderer)
        sights.append(panorama.sightings(scene.instances))
        panoramas.append(_as_text(panorama))
        positions.append(
            {
                "at": [round(c, 3) for c in point],
                "room": _room_at(plan, point),
                "next": list(neighbours),
                "seen": [
                    [
                        index[labels[sight.instance].category],
                        round(math.degrees(wrap_angle(sight.yaw))),
                        round(10.0 * sight.distance_m),
                    ]
                    for sight in sights[-1]
                ],
            }
        )
        if progress is not None:
            progress(number, len(graph.positions))
    names_of_rooms = [position["room"] for position in positions]
    middles = [names_of_rooms.index(name) for name in dict.fromkeys(names_of_rooms)]
    at, heading = _best_start({at: sights[at] for at in middles})
    return {
        "start": {"at": at, "heading": heading},
        "turn": _TURN_DEG,
        "slices": SLICES,
        "slope": round(half_slope(), 6),
        "names": names,
        "where": {
            name: [
                [round((i.box_min[k] + i.box_max[k]) / 2.0, 2) for k in (0, 1)]
                for i in scene.instances
                if i.id in labels and labels[i.id].category == name
            ]
            for name in names
        },
        "positions": positions,
        "panoramas": panoramas,
    }


def _as_text(panorama: Panorama) -> str:
    return base64.b64encode(panorama.webp()).decode("ascii")


def _room_at(plan: FloorPlan, point: tuple[float, float]) -> str:
    """Name of the room that a point lies in; empty outside all rooms."""
    for room in plan.rooms:
        if room.cell.x0 <= point[0] <= room.cell.x1 and room.cell.y0 <= point[1] <= room.cell.y1:
            return room.name
    return ""


def _best_start(sights: dict[int, list[Sighting]]) -> tuple[int, int]:
    """Position and heading (degrees) of a view with most objects."""

    def shown(at: int, heading: int) -> int:
        yaw = math.radians(heading)
        return sum(abs(wrap_angle(sight.yaw - yaw)) < _AHEAD for sight in sights[at])

    poses = [(at, heading) for at in sights for heading in range(0, 360, _TURN_DEG)]
    return max(poses, key=lambda pose: shown(*pose))
