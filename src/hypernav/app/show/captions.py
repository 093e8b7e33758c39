"""Captions: text for people about modes, questions, outcomes and numbers of a trace."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from hypernav.core.trace import DetectionRecord, Exchange, Mode, StepTrace, floor_of

Tone = Literal["good", "bad", "neutral"]

MODES: dict[Mode, str] = {
    Mode.LOOK_AROUND: "Looking around",
    Mode.RECALL: "Going to what it remembers",
    Mode.EXPLORE: "Exploring",
    Mode.APPROACH: "Going to the goal",
    Mode.VERIFY: "Checking",
    Mode.CLIMB: "On the stairs",
    Mode.STOP: "Stopped",
}

MODES_EXPLAINED: dict[Mode, str] = {
    Mode.LOOK_AROUND: "It turns on the spot to see what is near.",
    Mode.RECALL: "It goes to where it saw before what may be the goal.",
    Mode.EXPLORE: "It has not seen the goal and drives to a promising part of the map.",
    Mode.APPROACH: "It believes that it sees the goal and drives there.",
    Mode.VERIFY: "It stands in front of the goal and looks once more.",
    Mode.CLIMB: "It goes over stairs to another floor.",
    Mode.STOP: "It has ended its search.",
}

ITS_OWN = "its own"
"""Name of detector, reasoner and preset for an agent that has none of these components."""

QUESTIONS: dict[str, str] = {
    "ground": "Is it in the image?",
    "choose block": "Where to look next?",
    "crop": "Is it that, seen from nearby?",
    "verify": "Is it really there?",
    "summarise": "Which number was meant?",
    "choose arrow": "Which arrow to follow?",
    "choose direction": "Which way leads there?",
    "choose images": "Which remembered image shows it?",
    "rank images": "Which remembered image looks like it?",
    "score view": "Does it look as if it were near?",
    "stop": "Is the robot there?",
}

MODULES: dict[str, str] = {
    "render": "simulating the camera",
    "world": "simulating the world",
    "map": "drawing the map",
    "local": "looking for the goal",
    "global": "choosing where to look",
    "plan": "planning the path",
    "verify": "looking once more",
    "show": "filming",
}

_SHORT_QUESTION = 160

_PARTS_WITHOUT_MODEL: dict[str, str] = {
    "ground truth": "ground truth labels from the simulator (no model)",
    "geometric": "geometric rule (no model)",
    "noisy": "a stand-in that knows the truth and errs at a set rate (no model)",
    "systematic": "a stand-in that knows the truth and errs on the same things (no model)",
    "random block": "chance (no model)",
    "value map": "the value map",
    "truth": "a stand-in that knows what is in view (no model)",
}

_ENDINGS: dict[str, tuple[str, str]] = {
    "not_found": (
        "Did not find {goal}",
        "It was not where the robot looked, or the robot did not recognise it.",
    ),
    "wrong_place": ("Stopped, but not at {goal}", "The robot believed that it had arrived."),
    "unreachable": ("No path to {goal}", "No path leads to where the goal is."),
    "model_unavailable": (
        "Stopped: the model did not answer",
        "This is an outage, not a failure of the search, and counts as neither.",
    ),
    "interrupted": ("Interrupted while looking for {goal}", "Someone stopped the run."),
    "replayed": ("A recording, looked through for {goal}", ""),
}
_NEUTRAL = frozenset({"model_unavailable", "interrupted", "replayed"})


def floor_prefix(step: StepTrace) -> str:
    """The floor or stairs of a step, before other words; empty while only one floor is known."""
    if step.mode is Mode.CLIMB:
        return f"stairs from floor {floor_of(step)} · "
    return "" if step.floor is None else f"floor {step.floor} · "


def component_caption(name: str) -> str:
    """Name of a detector or reasoner for people; it distinguishes ground truth from models."""
    return _PARTS_WITHOUT_MODEL.get(_spaced(name), name)


def answerer_caption(exchange: Exchange) -> str:
    """Name of the component that answered, capitalised; a model's own name stays as it is."""
    return exchange.asked if exchange.by_model else sentence(component_caption(exchange.asked))


def is_ground_truth(detector: str) -> bool:
    """Whether a detector is given the answers by the simulator."""
    return _spaced(detector).startswith("ground truth")


def _spaced(name: str) -> str:
    return name.replace("-", " ").replace("_", " ").strip().lower()


def quoted(goal: str) -> str:
    """The goal between quotation marks."""
    return f"“{goal.strip()}”"


def question_caption(exchange: Exchange) -> str:
    """Subject of a question, in a few words."""
    return QUESTIONS.get(exchange.kind, exchange.kind.capitalize())


def final_question(question: str) -> str:
    """Final question of a long prompt: its last sentence that ends in a question mark.

    A short question, and one without a question mark, stays as it is.
    """
    text = " ".join(question.split())
    if len(text) <= _SHORT_QUESTION:
        return text
    end = text.rfind("?")
    if end < 0:
        return text
    start = max(text.rfind(mark, 0, end) for mark in ".!?:")
    return text[start + 1 : end + 1].strip()


def detections_caption(detections: list[DetectionRecord]) -> str:
    """Detections of the goal in a camera image, in one short line."""
    if not detections:
        return "goal not in view"
    accepted = [detection for detection in detections if detection.accepted]
    if accepted:
        best = max(accepted, key=lambda detection: detection.score)
        # Chat models and labels give no score, and 1 stands for that.
        sure = f", {best.score:.0%} sure" if best.score < 1.0 else ""
        return f"sees {quoted(best.label)}{sure}"
    best = max(detections, key=lambda detection: detection.score)
    why = f": {best.reason}" if best.reason else ""
    return f"{quoted(best.label)} not accepted{why}"


def camera_caption(step: StepTrace) -> str:
    """Question about the camera image of a step and its answer, in one line."""
    kinds = {"ground", "stop"}
    asked = [exchange for exchange in step.exchanges if exchange.kind in kinds]
    if not asked:
        return detections_caption(step.detections)
    answer = " ".join(asked[-1].answer.replace("```json", "").replace("```", "").split())
    if asked[-1].kind == "stop":
        return f"is the goal right here? {quoted(answer)}"
    return f"{detections_caption(step.detections)}  ·  {asked[-1].asked}: {quoted(answer)}"


@dataclass(frozen=True)
class Headline:
    """Outcome of an episode, in a few words.

    Attributes:
        text: Heading of a page.
        tone: Tone of the heading, which sets its colour.
        detail: Further sentence; may be empty.
    """

    text: str
    tone: Tone
    detail: str = ""


def sentence(text: str) -> str:
    """The text with a capital at its start."""
    return text[:1].upper() + text[1:]


def headline(result: Mapping[str, Any]) -> Headline:
    """Headline for the outcome of an episode.

    Args:
        result: Content of `result.json`; missing entries are allowed.
    """
    goal = quoted(str(result.get("goal", "the goal")))
    outcome, success = str(result.get("outcome", "")), result.get("success")
    if success or (outcome == "found" and success is None):
        return Headline(f"Found {goal}", "good")
    if outcome == "found":
        outcome = "wrong_place"
    text, detail = _ENDINGS.get(outcome, (f"Ended: {outcome.replace('_', ' ') or 'unknown'}", ""))
    if outcome == "not_found" and result.get("holds_goal") is False:
        detail = "Nothing in the building answers to it."
    elif outcome == "not_found" and _is_out_of_steps(result):
        detail = f"It was still looking when all {result['steps']} steps were used."
    if outcome == "not_found" and _is_finite(result.get("distance_to_goal_m")):
        away = number(result["distance_to_goal_m"], 1, "m")
        detail += f" It ended {away} of path from the nearest one."
    if result.get("detail"):
        words = "Why it ended: " if outcome == "not_found" else ""
        detail = f"{detail} {words}{result['detail']}".lstrip()
    tone: Tone = "neutral" if outcome in _NEUTRAL else "bad"
    return Headline(text.replace("{goal}", goal), tone, detail)


def _is_out_of_steps(result: Mapping[str, Any]) -> bool:
    steps, most_steps = result.get("steps"), result.get("max_steps")
    return isinstance(steps, int) and isinstance(most_steps, int) and steps >= most_steps


def _is_finite(value: object) -> bool:
    return isinstance(value, int | float) and math.isfinite(value)


def duration(seconds: float) -> str:
    """A time span for people: "12 ms", "3.4 s", "2 min 5 s"."""
    if seconds < 0.9995:
        return f"{seconds * 1000:.0f} ms" if seconds >= 0.0095 else f"{seconds * 1000:.1f} ms"
    if seconds < 59.95:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s"


def path_parts(result: Mapping[str, Any]) -> str:
    """How far a robot walked before and after it first saw the goal; empty if that is unknown."""
    explored, approached = result.get("explored_m"), result.get("approached_m")
    if not isinstance(explored, int | float) or not isinstance(approached, int | float):
        return ""
    after = _times(approached, result.get("shortest_from_sight_m"))
    if explored == 0.0:
        return f" It saw the goal from where it started, and walked {after} from there."
    before = _times(explored, result.get("shortest_path_m"))
    return f" It walked {before} before it saw the goal, and {after} from there."


def _times(length_m: float, shortest: object) -> str:
    """A length, and how many times the shortest path it is if that is known."""
    text = number(float(length_m), 1, "m")
    if not isinstance(shortest, int | float) or not 0.0 < shortest < math.inf:
        return text
    return f"{text} ({length_m / shortest:.1f} times the shortest path)"


def number(value: object, digits: int = 2, unit: str = "") -> str:
    """A number for people; a dash if it is missing, a sign if it is infinite."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, int | float) or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞"
    written = str(value) if isinstance(value, int) else f"{value:.{digits}f}"
    return f"{written}\u00a0{unit}" if unit else written
