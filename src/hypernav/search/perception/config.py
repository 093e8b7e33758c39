"""Configuration of perception, and the words of its questions: what detects, and what chooses."""

from string import Formatter
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, field_validator

from hypernav.core.components.abilities import missed_weight_of, score_weights_of
from hypernav.core.config import Curve, ProbabilityCurve, RoomConfig
from hypernav.core.score_weights import NEUTRAL
from hypernav.search.models.chat.config import FamilyName

GROUNDING_WORDS = (
    "Locate every {goal} in the picture and report the bounding boxes in JSON format, for example "
    '[{{"{key}": {example}, "label": "{goal}"}}]. If there is no {goal} in the picture, '
    "answer []."
)
CROP_WORDS = (
    "What is the thing in the middle of this image: {wanted}{others} or something else? "
    "Answer yes if it is {wanted}, else no."
)
"""The question about a crop."""
_PRESENCE = "Is there a {goal} in this picture? Answer yes or no."
_CONTEXT = (
    "A robot searches an unknown building for: {goal}. The picture is the map that it has drawn so "
    "far, seen from above: white is free floor, dark is walls and furniture, grey is not yet "
    "explored. The orange arrow is the robot and where it looks, the blue line is where it has "
    "been. The explored area is divided into numbered blocks: {numbers}."
)
_FREE = (
    "Which numbered block should the robot go to next to find the {goal}? Think about what kind of "
    "room each part may be and where unexplored space begins. Answer with the number of one block "
    "and a short reason."
)
_CONSTRAINED = (
    "Which numbered block should the robot go to next to find the {goal}? Answer with the number "
    "only."
)
_REASONED = (
    "A robot searches an unknown building for this: {goal}. The image is the map that it has drawn "
    "so far, seen from above: {legend}.\n\n"
    "It can go to these numbered blocks:\n{facts}\n\n"
    "Which numbered block should the robot go to next to find the {goal}? Think about what kind of "
    "room each part may be, where such a thing usually is and where unexplored space begins. "
    'Reason in two or three sentences. Then end with a last line "Answer: N", where N is one of '
    "{numbers}."
)
_SUMMARY = (
    "Somebody was asked for the number of one block on a map and answered:\n\n{answer}\n\n"
    "Which number did they choose? Possible are {numbers}. Answer with the number only."
)
_WORDS = {
    "paper": f"{_CONTEXT}\n\n{_FREE}",
    "reasoned": _REASONED,
    "constrained": f"{_CONTEXT}\n\n{_CONSTRAINED}",
}
_RECALL = (
    "This sheet shows numbered images that a robot took in a building. In which of these images do "
    "you see a {goal}? Look at small things and at the background, too. Answer with the numbers of "
    "these images only, for example: 2, 5. If it is in none of them, answer: none"
)
NEAR_M, FAR_M = 1.5, 5.0
"""Distances up to which the near rate of misses holds and from which on the far one does, as those
of YOLOX-nano were measured (benchmarks/detector_errors.py)."""


def _fillable(prompt: str, *names: str) -> str:
    """The text of a question, unchanged, if it holds no other names in braces, and no formats."""
    try:
        if any(spec or conversion for _, _, spec, conversion in Formatter().parse(prompt)):
            raise ValueError("formats")  # a width could fill the memory
        prompt.format(**dict.fromkeys(names, ""))
    except (AttributeError, KeyError, IndexError, ValueError) as error:
        *others, last = (f"{{{name}}}" for name in names)
        allowed = f"{', '.join(others)} and {last}" if others else last
        raise ValueError(f"may hold {allowed}; other braces are doubled: {{{{ }}}}") from error
    return prompt


def _odd(side: int) -> int:
    if side % 2 == 0:
        raise ValueError(
            f"a kernel needs an odd side, so that it has a middle; 1 does nothing, got {side}"
        )
    return side


OddSide = Annotated[int, Field(ge=1, le=101), AfterValidator(_odd)]
"""Side of a kernel, an odd number of cells or pixels."""


class LocalConfig(RoomConfig):
    """Configuration of local perception, from detections to goal areas.

    Values not marked with "paper" are ours: the paper is silent on them.

    Attributes:
        published_segmenter: Segmenter of the published method (paper: MobileSAM). Where another
            stands in for it, screens, results and reports say so. Empty: none is missed.
        pixels: Pixels of a detection that count: those of its "mask" (paper), or all of its "box",
            which are not eroded.
        erosion_px: Side of the kernel that erodes the mask, pixels, so that its edge does not spill
            onto the background (paper: "erode the segmentation area"; the size is ours); 1 does not
            erode.
        keep_thin_masks: Whether a mask of which erosion would leave less than a quarter stays as it
            is.
        min_points: Number of points with depth that a goal area needs.
        dilation_kernel: Side of the kernel that dilates the cells, cells (paper: 5×5).
        dilation_iterations: Number of dilations (paper: 3).
        largest_cluster_only: Whether to keep only the connected cells that most points fall into.
        entry_reach_m: Distance from the seen cells, metres, within which the robot may enter the
            goal area, but not behind a wall; 0 (paper) sends it to the dilated cells. A quarter
            less where the detector gave no mask, since guessed pixels spill over the goal's edge.
        target: Rule for the target, the candidate that is gone to. "latest": the newest detection
            of the goal, of several the detector's first (paper). "candidates": everything that may
            be the goal is remembered with the evidence for and against it, and the one most worth
            its path is the target; a doubtful one is looked at from another side before it is taken
            for the goal.
        rejected_for_looks: Number of images for which a rejected target is not taken for the goal
            again, where target is "latest".
        look_closer_below: Score of the goal below which the detector is asked once more, about the
            part of the image around the box, enlarged; the score is then the mean of both, and may
            be below the detector's threshold. 0 never looks closer.
        score_weights: Scores of boxes, in rising order, and how much an image with such a box
            shifts the log-odds that this is the goal, as measured by an exam; empty takes what is
            known of the detector, or `hypernav.core.score_weights.NEUTRAL`.
        missed_weight: The same shift by an image that should show a candidate, but gave no box of
            it; None takes what is known of the detector.
    """

    published_segmenter: str = ""
    pixels: Literal["mask", "box"] = "mask"
    erosion_px: OddSide = 5
    keep_thin_masks: bool = True
    min_points: int = Field(default=12, ge=1, le=1_000_000)
    dilation_kernel: OddSide = 5
    dilation_iterations: int = Field(default=3, ge=0, le=100)
    largest_cluster_only: bool = True
    entry_reach_m: float = Field(default=0.8, ge=0.0, le=50.0)
    target: Literal["latest", "candidates"] = "candidates"
    rejected_for_looks: int = Field(default=40, ge=1, le=10_000)
    look_closer_below: float = Field(default=0.6, ge=0.0, le=1.0)
    score_weights: Curve = ()
    missed_weight: float | None = Field(default=None, ge=-10.0, le=0.0)

    def for_detector(self, detector: object) -> "LocalConfig":
        """The configuration with what is known of a detector, where it says nothing itself."""
        known: dict[str, Any] = {}
        if not self.score_weights:
            known["score_weights"] = score_weights_of(detector) or NEUTRAL
        if self.missed_weight is None:
            known["missed_weight"] = missed_weight_of(detector)
        return self.model_copy(update=known)


class VlmDetectorConfig(RoomConfig):
    """Configuration of the question for boxes. Its wording and limits are ours.

    Attributes:
        family: Family of models whose coordinates the model answers in; "auto" reads it off the
            model's name.
        prompt: Text of the question. ``{goal}`` (without its own article), ``{key}`` (of a box) and
            ``{example}`` are filled in. A family that does not answer in JSON is asked in its
            makers' words instead, unless this is set.
        score_crops: Number of boxes of an image, the largest first, whose crops are asked about
            once more: the probability of "yes" is the box's score. 0 takes boxes as they are.
        min_score: Score below which a box is dropped.
        constrained: Whether to enforce the JSON form where the server can. The models were trained
            on free answers and these are read tolerantly, so it is rarely needed.
        max_tokens: Limit on the length of the answer, tokens; a box takes about 40.
    """

    family: Literal["auto", FamilyName] = "auto"
    prompt: str = GROUNDING_WORDS
    score_crops: int = Field(default=2, ge=0, le=1000)
    min_score: float = Field(default=0.3, ge=0.0, le=1.0)
    constrained: bool = False
    max_tokens: int = Field(default=300, ge=16, le=1_000_000)

    @field_validator("prompt")
    @classmethod
    def _can_be_filled_in(cls, prompt: str) -> str:
        return _fillable(prompt, "goal", "key", "example")


class DepthCutConfig(RoomConfig):
    """Configuration of the depth cut, which replaces the paper's MobileSAM; its values are ours.

    Attributes:
        depth_gap_m: Jump in depth between two pixels that ends the object, metres.
        floor_height_m: Height below which a pixel is floor, not the object, metres: floor touches
            the object without a jump in depth and often has its colour. 0 keeps it.
    """

    depth_gap_m: float = Field(default=0.15, gt=0.0, le=100.0)
    floor_height_m: float = Field(default=0.06, ge=0.0, le=10.0)


class PresenceConfig(RoomConfig):
    """Configuration of the presence check. The paper does not give its question: this one is ours.

    Attributes:
        enabled: Whether to ask, where there is a chat model.
        prompt: Text of the question; ``{goal}`` is filled in without its own article, and
            ``a {goal}`` with the right one.
        unsure: What an answer that is neither yes nor no counts as. "yes" trusts the detector.
        min_probability: Least probability of a "yes", where the model gives probabilities.
        calibration: Told and true probabilities of "yes", in rising order, as measured by an exam;
            empty takes the model at its word.
    """

    enabled: bool = True
    prompt: str = _PRESENCE
    unsure: Literal["yes", "no"] = "no"
    min_probability: float = Field(default=0.5, gt=0.0, le=1.0)
    calibration: ProbabilityCurve = ()


class DetectorQuality(RoomConfig):
    """Error rates of a detector. All values are ours.

    Attributes:
        missed_near: Probability that an object is missed in an image, if the median of its pixels
            is at most `NEAR_M` away.
        missed_far: The same probability from `FAR_M` on, and where no pixel has depth; linear
            between.
        never_found: Probability that an object is missed in every image of an episode: it looks
            unlike all that the detector has learned.
        confused_alike: Probability that an object that resembles the goal is taken for it; drawn
            once for an episode, and missed as often as the goal in the images after that.
        confused_other: The same probability for an object that doesn't resemble the goal.
        false_alarms: Mean number of boxes per image at random positions.
        right_score: Mean score of the goal.
        wrong_score: Mean score of everything else.
        score_sd: Standard deviation of both scores, before they are cut to 0.05 to 1.
        jitter_px: Standard deviation of the edges of boxes, pixels.
    """

    missed_near: float = Field(default=0.0, ge=0.0, le=1.0)
    missed_far: float = Field(default=0.0, ge=0.0, le=1.0)
    never_found: float = Field(default=0.0, ge=0.0, le=1.0)
    confused_alike: float = Field(default=0.0, ge=0.0, le=1.0)
    confused_other: float = Field(default=0.0, ge=0.0, le=1.0)
    false_alarms: float = Field(default=0.0, ge=0.0, le=100.0)
    right_score: float = Field(default=1.0, ge=0.0, le=1.0)
    wrong_score: float = Field(default=1.0, ge=0.0, le=1.0)
    score_sd: float = Field(default=0.0, ge=0.0, le=1.0)
    jitter_px: float = Field(default=0.0, ge=0.0, le=1000.0)

    def missed_at(self, distance_m: float) -> float:
        """Probability of a miss in an image at a distance, metres; it may be infinite."""
        rates = (self.missed_near, self.missed_far)
        return float(np.interp(distance_m, (NEAR_M, FAR_M), rates))


class OverviewConfig(RoomConfig):
    """Configuration of the map question. The paper gives no values for it: these are ours.

    Attributes:
        image_px: Side of the image of the map, pixels; a multiple of 28 fits the patches of most
            models.
        strong_colors: Whether unknown stands out from free floor, with a contrast of at least 3:1.
        draw_frontier: Whether the boundary to the unknown is drawn in a colour.
        fill_obstacles: Whether the inside of furniture and walls, which no camera sees, is filled.
        clear_numbers: Whether numbers are larger and keep off furniture.
        label_things: Whether things that a detector has named beside the goal are written into the
            map.
        visited: What counts as a visit: "destinations" that were reached or given up, or the
            "positions" that the robot has been at (paper), beside the latest destination, so that
            the next is a new one. "none": nothing counts.
        visited_radius_m: Distance from a visit, metres, within which a destination counts as
            visited.
        max_questions: Largest number of questions for one choice, with visited blocks excluded;
            None asks until an unvisited block is named or all are excluded (paper).
        forget_visits: Whether visits are forgotten when all blocks are excluded, so that the search
            goes on; else nothing is left to explore.
        last_frontier_m: Length of the shortest frontier that is visited where no block is left,
            metres: the edges of blocks and thin obstacles cut boundaries into pieces too short to
            count, and a square with little floor is no block. None visits none.
    """

    image_px: int = Field(default=756, ge=64, le=4096)
    strong_colors: bool = True
    draw_frontier: bool = True
    fill_obstacles: bool = True
    clear_numbers: bool = True
    label_things: bool = True
    visited: Literal["destinations", "positions", "none"] = "destinations"
    visited_radius_m: float = Field(default=0.5, ge=0.0, le=100.0)
    max_questions: int | None = Field(default=4, ge=1, le=1000)
    forget_visits: bool = False
    last_frontier_m: float | None = Field(default=0.25, ge=0.0, le=50.0)


class VlmReasonerConfig(RoomConfig):
    """Configuration of the map question to a model. Values not marked with "paper" are ours.

    Attributes:
        mode: Form of the answer. "paper": free text, summarised to a number by rules and, where
            they fail, by a second short question. "reasoned": a short reasoning and a last line
            "Answer: N", which are read in the same way. "constrained": the numbers are the only
            possible answers.
        prompt: Text of the question; ``{goal}``, ``{numbers}`` (of the blocks shown; if "reasoned",
            of those that may be answered), ``{legend}`` (of the image) and ``{facts}`` (about the
            blocks) are filled in. None: our words for the mode.
        summary_prompt: Text of the second question; ``{answer}`` and ``{numbers}`` are filled in.
        facts: Whether ``{facts}`` says for each block how far it is, in which direction, what share
            of the unexplored boundary it holds, whether the robot was there and which things a
            detector has named there beside the goal; else it gives the numbers only.
        list_excluded: Whether blocks that are ruled out are shown like all others and named in
            "don't answer number [x, …]" (paper), instead of being hatched and left out.
        min_frontier_cells: Length of unexplored boundary, cells, below which a block holds nothing
            new and is left out; 0 leaves none out (paper).
        max_blocks: Largest number of blocks to choose from, those with the longest boundaries; None
            for all.
        max_tokens: Limit on the length of a free answer, tokens.
        skip_only_block: Whether to go without a question where only one block is left.
    """

    mode: Literal["paper", "reasoned", "constrained"] = "reasoned"
    prompt: str | None = None
    summary_prompt: str = _SUMMARY
    facts: bool = True
    list_excluded: bool = False
    min_frontier_cells: int = Field(default=6, ge=0, le=1_000_000)
    max_blocks: int | None = Field(default=20, ge=1, le=10_000)
    max_tokens: int = Field(default=300, ge=16, le=1_000_000)
    skip_only_block: bool = True

    @field_validator("prompt")
    @classmethod
    def _prompt_can_be_filled_in(cls, prompt: str | None) -> str | None:
        if prompt is None:
            return None
        return _fillable(prompt, "goal", "numbers", "legend", "facts")

    @field_validator("summary_prompt")
    @classmethod
    def _summary_can_be_filled_in(cls, prompt: str) -> str:
        return _fillable(prompt, "answer", "numbers")

    @property
    def words(self) -> str:
        """Text of the question, before anything is filled in."""
        return _WORDS[self.mode] if self.prompt is None else self.prompt


class GeometricConfig(RoomConfig):
    """Choice of a block. The paper always asks a model, so these values are ours.

    Attributes:
        gain: What a block is worth: the length of its "boundary" to the unknown, or the area of
            unknown floor that its "view" would show.
        order: Which block comes next: the one of the greatest value, "greedy", or the first one of
            a "tour" over the most valuable ones.
        min_frontier_cells: Length of unexplored boundary, cells, below which a block holds nothing
            new; with 0, a block without any may be visited as well, after all others.
    """

    gain: Literal["boundary", "view"] = "view"
    order: Literal["greedy", "tour"] = "tour"
    min_frontier_cells: int = Field(default=6, ge=0, le=1_000_000)


class ImageRecallConfig(RoomConfig):
    """What is made of remembered images; the paper has none.

    Attributes:
        prompt: Text of the question; ``{goal}`` is filled in, with its own article for
            ``a {goal}``.
        max_questions: Number of questions in one search about one floor, each about six images;
            0 asks none.
        least_similarity: Where no chat model is asked: how far an image must stand out by its
            similarity to the goal's words, for a model of ``--similarity``, for the robot to go
            there; in standard deviations of all images (`hypernav.search.perception.image_recall`).
    """

    prompt: str = _RECALL
    max_questions: int = Field(default=4, ge=0, le=100)
    least_similarity: float = Field(default=3.0, ge=0.0, le=1000.0)
