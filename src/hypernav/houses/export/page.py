"""Web page about one building: floor plan and walk, top view, interior views, list of objects."""

from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from hypernav.core.errors import SceneError
from hypernav.core.labels import ObjectLabel
from hypernav.houses.assembly import to_scene
from hypernav.houses.building import Building
from hypernav.houses.export.floor_plan_svg import floor_plan_svg
from hypernav.houses.export.views import interior_views, views_from_above
from hypernav.houses.export.walk import walk_data
from hypernav.houses.export.walk_graph import walk_graph
from hypernav.houses.generator import build_compact, storeys_of
from hypernav.io.writing import write_whole
from hypernav.show.pages.templating import image_uri, page_environment
from hypernav.worlds.drawing.renderer import CpuRenderer
from hypernav.worlds.surface.walkable import WalkableGrid


def building_page(
    building: Building, out: Path, *, progress: Callable[[int, int], None] | None = None
) -> Path:
    """Write a self-contained page about a building.

    Args:
        building: The building.
        out: File of the page; or a folder, in which it is called ``house_N.html`` or
            ``office_N.html``.
        progress: Function that is called with the numbers of drawn panoramas and of all.

    Returns:
        File of the page.

    Raises:
        SceneError: The page cannot be written.
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
    # The walk is on the storey with the entrance.
    plan = next(plan for plan in storeys if plan.floor_z == 0.0)
    scene = to_scene(build_compact(building), building.scene)
    grid = WalkableGrid.from_scene(scene, floor_z=0.0 if scene.storeys else None)
    graph = walk_graph(grid, plan)
    with closing(CpuRenderer(scene)) as renderer:
        views = interior_views(scene, plan, building.number, 4, grid=grid, renderer=renderer)
        walk = walk_data(scene, plan, graph, grid=grid, renderer=renderer, progress=progress)
    rooms = [room for plan in storeys for room in plan.rooms if not room.is_outside]
    labels = [i.label for i in scene.instances if i.label and i.label.category != "window"]
    return (
        page_environment("hypernav.houses")
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
            walk=walk,
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
