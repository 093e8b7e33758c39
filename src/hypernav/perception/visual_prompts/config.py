"""Configuration of the methods that draw moves into the camera image (VLMnav, PIVOT, DyNaVLM)."""

from pydantic import Field

from hypernav.core.config import MOST_SEED, RoomConfig


class ArrowsConfig(RoomConfig):
    """Where VLMnav's released code differs from its authors' intention, or from ours.

    Its other values, and those of ours, are constants beside the code that uses them.

    Attributes:
        slide_marks: Whether the mark of an end below the image is slid along its direction into the
            image; ours. Without it such an arrow is left out, as in VLMnav's code, whose camera
            looks down: a level camera at 0.88 m would hardly ever show one.
        blind_step_m: Length of the step ahead where an answer names nothing, metres; 0.2 in
            VLMnav's code. None takes the robot's own step (ours).
        space_explored: Whether explored arrows of VLMnav keep an angle among themselves as well.
            The original means to, but compares with a stale angle.
        zero_is_last: Whether number 0 means the last mark of PIVOT instead of turning around: a
            mistake of VLMnav's code.
        count_short: Whether the question names one arrow less than there are where the robot may
            not turn around: a mistake of VLMnav's code.
        outage_is_no_answer: Whether a model that isn't available counts as an answer without a
            number, which is a step ahead, as in VLMnav's code; else the episode ends with that
            outcome. It holds for choices of arrows only, not for the stop check.
        max_tokens: Limit on the length of an answer, tokens (VLMnav's code).
        seed: Seed of PIVOT's marks and of the choice among explored arrows without a model; equal
            searches make equal choices (ours).
    """

    slide_marks: bool = True
    blind_step_m: float | None = Field(default=None, gt=0.0, le=10.0)
    space_explored: bool = True
    zero_is_last: bool = False
    count_short: bool = False
    outage_is_no_answer: bool = False
    max_tokens: int = Field(default=500, ge=8, le=100_000)
    seed: int = Field(default=0, ge=0, le=MOST_SEED)
