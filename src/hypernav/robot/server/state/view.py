"""What people see of one search: its map, its last image, and the robot's pose."""

from dataclasses import dataclass, replace

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.trace import StepTrace
from hypernav.robot.server.maps import extent_of
from hypernav.robot.server.state.journal import Journal
from hypernav.robot.wire.frames import PackedObservation, unpack_observation
from hypernav.robot.wire.replies import MapExtent


@dataclass(frozen=True, eq=False)
class View:
    """A value that is replaced at every change.

    After the end of a search its map and image are on the disk and no longer in here, because a
    server keeps many searches.

    Attributes:
        pose: Last pose of the robot ``(x, y, yaw)``, ``map`` frame; None before the first decision.
        extent: Where the map lies; None before the first decision.
        grid: Map after the last decision; None before the first, and after the end.
        colour: Format and bytes of the last colour image; None before the first, and after the end.
    """

    pose: tuple[float, float, float] | None = None
    extent: MapExtent | None = None
    grid: OccupancyGrid | None = None
    colour: tuple[str, bytes] | None = None

    @staticmethod
    def of(journal: Journal) -> "View":
        """What a journal holds.

        Raises:
            HyPerNavError: It is damaged.
        """
        is_over, steps = journal.end is not None, journal.step_count
        view = View() if is_over else View(colour=image_of(journal))
        trace = journal.step(steps - 1).trace if steps > 0 else None
        view = view.with_step(trace, journal.read_map() if is_over else None)
        return view.kept_on(journal) if is_over else view

    def with_image(self, packed: PackedObservation) -> "View":
        """With the colour image of an observation that was accepted."""
        return replace(self, colour=(packed.header.colour.format, packed.colour))

    def with_step(self, trace: StepTrace | None, grid: OccupancyGrid | None) -> "View":
        """With pose and map after a decision; None leaves what there is."""
        view = self if trace is None else replace(self, pose=trace.pose)
        return view if grid is None else replace(view, grid=grid, extent=extent_of(grid))

    def kept_on(self, journal: Journal) -> "View":
        """Without image and map, once the journal has them."""
        return replace(self, colour=None, grid=None if journal.has_map else self.grid)


def image_of(journal: Journal, sequence: int | None = None) -> tuple[str, bytes] | None:
    """Format and bytes of an observation's colour image; None before it has come.

    Args:
        journal: The journal.
        sequence: Number of the observation; None is the last.

    Raises:
        HyPerNavError: It is damaged on the disk.
    """
    sequence = journal.observation_count - 1 if sequence is None else sequence
    if not 0 <= sequence < journal.observation_count:
        return None
    packed = unpack_observation(journal.observation(sequence))
    return packed.header.colour.format, packed.colour
