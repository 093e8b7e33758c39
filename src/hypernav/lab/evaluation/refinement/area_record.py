"""What is kept of the goal areas of an episode: one record for every kind of box and mask."""

from dataclasses import dataclass, replace
from enum import StrEnum

from hypernav.core.episode import Episode
from hypernav.lab.evaluation.record import EpisodeLine
from hypernav.lab.evaluation.refinement.footprint import OffTarget
from hypernav.lab.evaluation.refinement.goal_position import GoalPosition


class BoxSource(StrEnum):
    """Where the box of a goal comes from."""

    TRUE = "true"
    """The tight box of the visible pixels."""
    JITTERED = "jittered"
    """The true box with noisy edges."""
    DETECTED = "detected"
    """The box of a real detector that belongs to the true one."""


class MaskSource(StrEnum):
    """What is done with a box: which pixels are projected, and whether their cells are dilated."""

    RAW = "raw box"
    """All of its pixels, neither eroded nor dilated (paper: without refinement)."""
    BOX = "dilated box"
    """All of its pixels, dilated: shows what the mask alone is worth."""
    SEGMENTED = "refined"
    """The eroded mask of the segmenter, dilated (paper: refinement)."""
    TRUE = "true mask"
    """The eroded true mask, dilated: an upper bound for segmenters."""


@dataclass(frozen=True)
class AreaRecord:
    """The goal areas that one kind of box and mask gave in the frames of one episode.

    Attributes:
        scene_id: Scene of the episode.
        episode_id: Name of the episode within the scene.
        goal: Text of the goal.
        box: Source of the boxes.
        mask: What was done with them.
        first_off: Share of the first goal area's cells, before dilation, that are off the
            footprint; None without an area.
        position: Position that the first goal area sends the robot to; None without an area.
        frames: Number of frames that had such a box.
        empty: Number of frames in which too little was left for a goal area.
        seen: Number of the cells that the pixels fall into, before dilation, in all frames.
        seen_off: Number of these cells that are off the footprint.
    """

    scene_id: str
    episode_id: str
    goal: str
    box: BoxSource
    mask: MaskSource
    first_off: float | None
    position: GoalPosition | None = None
    frames: int = 0
    empty: int = 0
    seen: int = 0
    seen_off: int = 0

    @staticmethod
    def begun(episode: Episode, box: BoxSource, mask: MaskSource) -> "AreaRecord":
        """A record without frames."""
        return AreaRecord(episode.scene_id, episode.episode_id, episode.goal.text, box, mask, None)

    def after(self, cells: OffTarget | None) -> "AreaRecord":
        """The record with one more frame; None stands for a frame without a goal area."""
        if cells is None:
            return replace(self, frames=self.frames + 1, empty=self.empty + 1)
        return replace(
            self,
            first_off=cells.share_off if self.first_off is None else self.first_off,
            frames=self.frames + 1,
            seen=self.seen + cells.seen,
            seen_off=self.seen_off + cells.seen_off,
        )


class EpisodeAreas(EpisodeLine):
    """The results of an episode: one line of the study's file.

    Attributes:
        areas: A record for every kind of box and mask; empty if the goal was never within the range
            of depth.
    """

    areas: tuple[AreaRecord, ...]
