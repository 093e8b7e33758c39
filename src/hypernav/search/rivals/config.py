"""Configuration of the published rivals, and the words of their questions."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import MOST_SEED, RoomConfig

ONE_ARROW = (
    "You steer a robot that looks for the nearest {goal} in a building that it doesn't know, and "
    "has to come as close to it as it can. The picture is what its camera sees now. {arrows}{turn} "
    "Use what you know of how buildings are furnished. First say what you see, and whether "
    "anything hints at a {goal}. Then say in which direction the robot should go, and which number "
    "leads there best. It can't pass a closed door, and it needs no stairs.{facts} "
    'End with that number as JSON: {{"action": NUMBER}}'
)
SEVERAL_ARROWS = (
    "You steer a robot on wheels that looks for a {goal} and can't go over or through things. The "
    "picture is what its camera sees now. {arrows}{turn} Which {wanted} of them are the best to "
    "go to, to find a {goal}? Explain nothing.{facts} Answer with their numbers, the best first, "
    'as JSON: {{"actions": [NUMBER, …]}}'
)
DIRECTION = (
    "A robot looks for a {goal} in a building. The{first} picture is what its camera sees now."
    "{past} Where should it go to find a {goal}: to the left, to the right, straight on, or, if "
    "nothing in the picture leads to a {goal}, should it explore more? Answer with one of: left, "
    "right, straight, explore more."
)
DIRECTION_PAST = (
    " The second shows what it saw at its last choice, beside the map that it has drawn: white is "
    "free floor, dark is walls and furniture, grey is not yet explored; the arrow is the robot and "
    "the blue line its path."
)
_SCORE = (
    "You look for a {goal} in a building. Is the place in this picture one from which a {goal} is "
    "likely close by? Answer yes or no."
)
_STOP = (
    "A robot looks for a {goal}. The picture is what its camera sees now. Is the robot already "
    "VERY close to a real {goal}? Take care not to mistake another piece of furniture for it. If "
    "there is none, if it is far away or if you aren't sure, say no. Answer yes or no."
)


class ValueFrontierConfig(RoomConfig):
    """Choice of a frontier by the value map. Values are those of VLFM's code unless said ours.

    Attributes:
        visited_radius_m: Distance from a destination that was reached or given up, metres, within
            which frontiers are passed over; ours: the original may go there for ever.
    """

    visited_radius_m: float = Field(default=0.5, ge=0.0, le=100.0)


class TruthScorerConfig(RoomConfig):
    """Quality of the stand-in.

    Attributes:
        noise: Standard deviation of the errors that are added to the scores. The same view of the
            same goal always has the same error.
    """

    noise: float = Field(default=0.0, ge=0.0, le=10.0)


class ChatScorerConfig(RoomConfig):
    """The question. All of it is ours.

    Attributes:
        prompt: Text of the question; ``{goal}`` is filled in.
    """

    prompt: str = _SCORE


class AreaConfig(RoomConfig):
    """Areas and turns. Values are those of NavVLM's code unless said ours.

    Attributes:
        visited_radius_m: Distance from an area that was reached or given up, metres, within which
            another is passed over; ours: the original may go to and fro.
        clear_rows: Whether a row of the map that holds anything outside the largest piece is
            dropped altogether: a mistake of the original.
    """

    visited_radius_m: float = Field(default=0.5, ge=0.0, le=100.0)
    clear_rows: bool = False


class ChatGuideConfig(RoomConfig):
    """The question, in substance NavVLM's, in our words.

    Attributes:
        max_tokens: Limit on the length of an answer, tokens; ours.
    """

    max_tokens: int = Field(default=64, ge=4, le=100_000)


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
        max_tokens: Limit on the length of an answer, tokens (VLMnav's code).
        seed: Seed of PIVOT's marks and of the choice among explored arrows without a model; equal
            searches make equal choices (ours).
    """

    slide_marks: bool = True
    blind_step_m: float | None = Field(default=None, gt=0.0, le=10.0)
    space_explored: bool = True
    zero_is_last: bool = False
    count_short: bool = False
    max_tokens: int = Field(default=500, ge=8, le=100_000)
    seed: int = Field(default=0, ge=0, le=MOST_SEED)


class StopCheckConfig(RoomConfig):
    """The question whether to stop.

    Attributes:
        prompt: Text of the question, in substance VLMnav's; ``{goal}`` is filled in.
    """

    prompt: str = _STOP


class PromptedConfig(RoomConfig):
    """Budget and stop of an agent that makes long moves.

    Attributes:
        most_moves: Number of moves after which the search is given up (VLMnav's code).
        most_actions: Number of actions of 0.5 m and 30 degrees after which it is given up: the
            budget of all other agents (ours).
        stop: Configuration of the question whether the robot is at the goal.
    """

    most_moves: int = Field(default=40, ge=1, le=100_000)
    most_actions: int = Field(default=500, ge=1, le=1_000_000)
    stop: StopCheckConfig = StopCheckConfig()


class PolicyConfig(RoomConfig):
    """Choice of an action by its score.

    Attributes:
        choice: "sample" draws an action by its probability, as the published evaluations of
            policies that were trained by reward do; "mode" takes the likeliest (PIRLNav's, of its
            policies that were trained by imitation alone).
        seed: Seed of the draws; equal searches draw equal actions (ours).
        goals: Safetensors file for ZSON with one vector for each goal, under the goal's words:
            CLIP's (RN50) text embedding of these bare words.
    """

    choice: Literal["sample", "mode"] = "sample"
    seed: int = Field(default=0, ge=0, le=MOST_SEED)
    goals: str = ""
