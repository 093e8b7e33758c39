"""The parts of the generator that differ between kinds of buildings."""

from collections.abc import Callable
from dataclasses import dataclass

from hypernav.houses.furnishing.rooms import Furnishing
from hypernav.houses.plan.shapes import FloorPlan
from hypernav.houses.random_stream import RandomStream
from hypernav.houses.shell.room_finishes import RoomFinish


@dataclass(frozen=True)
class BuildingKind:
    """Kind of building: its plans, its surfaces and its furniture.

    Attributes:
        sample_plan: Gives the floor plan of the building with a number.
        sample_finishes: Gives the finishes of rooms of these kinds.
        furnishing: Rules by which its rooms are furnished.
    """

    sample_plan: Callable[[RandomStream, int], FloorPlan]
    sample_finishes: Callable[[RandomStream, list[str]], list[RoomFinish]]
    furnishing: Furnishing
