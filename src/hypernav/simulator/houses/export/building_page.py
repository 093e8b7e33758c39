"""Web page about one building: a view to be turned, plans, images, list of objects."""

from collections.abc import Callable, Sequence
from contextlib import closing
from html import escape
from pathlib import Path
from typing import Any

from hypernav.app.show.spatial.view import library
from hypernav.app.show.templating import image_uri, page_environment
from hypernav.core.errors import SceneError
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.io.writing import write_whole
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.export.building_space import building_space
from hypernav.simulator.houses.export.building_views import interior_views, views_from_above
from hypernav.simulator.houses.generator import build_compact, storeys_of
from hypernav.simulator.houses.house_cache import checked_scene
from hypernav.simulator.houses.plan.floor_plan import OUTER_M, WALL_M, FloorPlan, Opening, Rect
from hypernav.simulator.houses.plan.openings import leaf_rect
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

_FILLS = {
    kind: color
    for color, kinds in {
        "#fdebd3": ("living room", "reception", "bookshop", "library"),
        "#fdf6cf": ("kitchen", "pantry", "reading room", "staff room"),
        "#fbe0cf": ("dining room", "lounge", "clothes shop"),
        "#dfe8f6": ("bedroom", "meeting room", "conference room", "study room"),
        "#d8f0f0": ("bathroom", "restroom"),
        "#eeeeee": ("hall", "corridor", "arcade", "stairwell"),
        "#e2f1de": ("office", "open office", "supermarket"),
        "#ece0f2": ("laundry", "copy room", "server room", "fitting room"),
        "#e4e0da": ("storage", "hardware store", "stock room"),
        "#dcecd6": ("balcony",),
    }.items()
    for kind in kinds
}
_LEAST_HEIGHT_M = 0.12


def floor_plan_svg(plan: FloorPlan, instances: tuple[Instance, ...]) -> str:
    """SVG drawing of rooms with names and areas, walls, doors, windows, stairs and furniture."""
    x0 = min(r.cell.x0 for r in plan.rooms) - 0.5
    x1 = max(r.cell.x1 for r in plan.rooms) + 0.5
    y0 = min(r.cell.y0 for r in plan.rooms) - 0.5
    y1 = max(r.cell.y1 for r in plan.rooms) + 0.5
    parts = [
        f'<svg viewBox="{x0:.2f} {-y1:.2f} {x1 - x0:.2f} {y1 - y0:.2f}" role="img" '
        'aria-label="Floor plan" xmlns="http://www.w3.org/2000/svg">'
    ]
    for room in plan.rooms:
        if not room.is_outside:
            parts.append(_rect(room.cell.grown(OUTER_M), "#3d4148"))
    for room in plan.rooms:
        outline = ' stroke="#3d4148" stroke-width="0.04"' if room.is_outside else ""
        parts.append(_rect(room.inner, _FILLS[room.kind], outline))
    if plan.stairwell is not None:
        edge = ' stroke="#3d4148" stroke-width="0.02"'
        for room in range(len(plan.rooms)):
            parts += [_rect(rect, "#c9ccd1") for rect in plan.left_out(room, below=True)]
        if plan.stairwell.leads_up:
            parts += [_rect(step.rect, "#e8d9c5", edge) for step in plan.stairwell.steps]
    parts += [_opening(plan, o) for o in plan.openings]
    for instance in instances:
        label = instance.label
        if label is None or label.category in ("door", "window"):
            continue
        low, high = (z - plan.floor_z for z in (instance.box_min[2], instance.box_max[2]))
        if label.category in ("stairs", "ramp") or not (
            -0.1 < low <= 1.0 and high >= _LEAST_HEIGHT_M
        ):
            continue
        (a, b, _), (c, d, _) = instance.box_min, instance.box_max
        title = f"<title>{escape(label.category)}</title>"
        parts.append(
            f'<rect x="{a:.2f}" y="{-d:.2f}" width="{c - a:.2f}" height="{d - b:.2f}" '
            'rx="0.03" fill="#ffffff" fill-opacity="0.55" stroke="#6b7280" '
            f'stroke-width="0.02">{title}</rect>'
        )
    for room in plan.rooms:
        x, y = room.inner.centre
        size = min(0.34, room.inner.width / 5.0)
        name, area = escape(room.name), f"{room.inner.area:.1f} m²"
        parts.append(
            f'<text x="{x:.2f}" y="{-y:.2f}" font-size="{size:.2f}" text-anchor="middle" '
            'font-family="system-ui, sans-serif" fill="#1c242e" paint-order="stroke" '
            f'stroke="#ffffff" stroke-width="0.06">{name}'
            f'<tspan x="{x:.2f}" dy="1.15em">{area}</tspan></text>'
        )
    return "".join([*parts, "</svg>"])


def _rect(r: Rect, fill: str, extra: str = "") -> str:
    return (
        f'<rect x="{r.x0:.3f}" y="{-r.y1:.3f}" width="{r.width:.3f}" height="{r.depth:.3f}" '
        f'fill="{fill}"{extra}/>'
    )


def _opening(plan: FloorPlan, opening: Opening) -> str:
    outside = [k < 0 or plan.rooms[k].is_outside for k in opening.rooms]
    low, high = -OUTER_M if outside[0] else -WALL_M / 2, OUTER_M if outside[1] else WALL_M / 2
    hole = opening.strip(low, high)
    if opening.kind == "window":
        return _rect(hole, "#9cc7ea") + _rect(opening.strip(-0.02, 0.02), "#3d4148")
    if opening.kind == "entrance":
        return _rect(hole, "#b4583c")
    drawn = _rect(hole, "#f7f3ec")
    leaf = leaf_rect(opening)
    return drawn + (_rect(leaf, "#8a6a4a") if leaf is not None else "")


def building_page(
    building: Building, out: Path, *, progress: Callable[[int, int], None] | None = None
) -> Path:
    """Write a self-contained page about a building.

    Args:
        building: The building.
        out: File of the page; or a folder, in which it is called ``house_N.html`` or
            ``office_N.html``.
        progress: Function that is called with the numbers of drawn images and of all.

    Returns:
        File of the page.

    Raises:
        SceneError: The page cannot be written; or the building belongs to a split that is
            shipped, and is drawn differently here.
    """
    path = out if out.suffix == ".html" else out / f"{building.file_stem}.html"
    text = _page(building, progress)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text)
    except OSError as error:
        raise SceneError(f"{path}: cannot be written ({error.strerror or error})") from error
    return path


def _page(building: Building, progress: Callable[[int, int], None] | None) -> str:
    storeys = storeys_of(building)
    plan = next(plan for plan in storeys if plan.floor_z == 0.0)
    scene = checked_scene(building, build_compact(building), building.scene)
    grid = WalkableGrid.from_scene(scene, floor_z=0.0 if scene.storeys else None)
    with closing(CpuRenderer(scene)) as renderer:
        views = interior_views(scene, plan, building.number, 4, grid=grid, renderer=renderer)
        space = building_space(scene, storeys, renderer, progress)
    rooms = [room for plan in storeys for room in plan.rooms if not room.is_outside]
    labels = [i.label for i in scene.instances if i.label and i.label.category != "window"]
    return (
        page_environment("hypernav.simulator.houses")
        .get_template("building.html.j2")
        .render(
            noun=building.noun,
            number=building.number,
            area=f"{sum(room.inner.area for room in rooms):.0f}",
            floors="one floor" if len(storeys) == 1 else f"{len(storeys)} floors",
            rooms=[room.name for plan in storeys for room in plan.rooms],
            plan=floor_plan_svg(plan, scene.instances),
            others=[
                (f"{one.floor_z:+.1f} m", floor_plan_svg(one, scene.instances))
                for one in storeys
                if one is not plan
            ],
            above=[image_uri(view) for view in views_from_above(scene, storeys)],
            views=[image_uri(view) for view in views],
            space=space,
            library=library(),
            categories=_by_category(labels),
            total=len(labels),
            triangles=f"{len(scene.faces):,}",
        )
    )


def _by_category(labels: Sequence[ObjectLabel]) -> list[dict[str, Any]]:
    """One entry per category: number of objects, names, rooms and looks."""
    kinds: dict[str, list[ObjectLabel]] = {}
    for label in labels:
        kinds.setdefault(label.category, []).append(label)
    return [
        {
            "name": category,
            "count": len(own),
            "synonyms": sorted({name for label in own for name in label.synonyms}),
            "rooms": sorted({label.room for label in own}),
            "attributes": sorted({word for label in own for word in label.attributes}),
        }
        for category, own in sorted(kinds.items())
    ]
