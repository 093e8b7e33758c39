"""Houses out of boxes, in place of generated ones where building these would take too long."""

from pathlib import Path

from box_scenes import room_boxes, scene_of
from hypernav.simulator.houses.building import Building
from hypernav.simulator.worlds.scenes.scene import Scene


def box_house(building: Building, folder: Path | None = None) -> Scene:
    """A room with a bed and a chair, whatever the number; takes what `cached_building` takes."""
    bed = ("bed", (4.0, 0.1, 0.0), (5.9, 1.7, 0.5))
    chair = ("chair", (0.1, 3.4, 0.0), (0.6, 3.9, 0.9))
    return scene_of(*room_boxes(6.0, 4.0), bed, chair, name=building.scene)
