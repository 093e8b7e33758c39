"""Steps and questions as JSON messages for Foxglove, which has no message types for them."""

from typing import Any

from hypernav.core.trace import Exchange, StepTrace

# Foxglove reads fields of plain types: no references, no alternatives, no arrays of arrays.
_TEXT, _NUMBER, _COUNT, _FLAG = (
    {"type": kind} for kind in ("string", "number", "integer", "boolean")
)


def _schema(title: str, fields: dict[str, Any]) -> dict[str, Any]:
    return {"title": title, "type": "object", "properties": fields}


STEP_SCHEMA = _schema(
    "hypernav.Step",
    {
        "step": _COUNT,
        "mode": _TEXT,
        "reason": _TEXT,
        "action": _TEXT,
        "ending": _TEXT,
        "seconds": _NUMBER,
        "events": {"type": "array", "items": _TEXT},
        "detections": {
            "type": "array",
            "items": _schema(
                "detection",
                {"label": _TEXT, "score": _NUMBER, "accepted": _FLAG, "reason": _TEXT},
            ),
        },
    },
)
QUESTION_SCHEMA = _schema(
    "hypernav.Question",
    {
        "step": _COUNT,
        "kind": _TEXT,
        "asked": _TEXT,
        "question": _TEXT,
        "answer": _TEXT,
        "fault": _TEXT,
        "tokens_in": _COUNT,
        "tokens_out": _COUNT,
        "seconds": _NUMBER,
    },
)


def step_fields(step: StepTrace) -> dict[str, Any]:
    """The step as a message of `STEP_SCHEMA`."""
    return {
        "step": step.step,
        "mode": step.mode.value,
        "reason": step.reason,
        "action": "" if step.action is None else step.action.name.lower().replace("_", " "),
        "ending": "" if step.ending is None else step.ending.value,
        "seconds": sum(step.seconds.values()),
        "events": step.events,
        "detections": [
            one.model_dump(include={"label", "score", "accepted", "reason"})
            for one in step.detections
        ],
    }


def question_fields(number: int, exchange: Exchange) -> dict[str, Any]:
    """A question and its answer as a message of `QUESTION_SCHEMA`."""
    kept = QUESTION_SCHEMA["properties"].keys() - {"step"}
    return {"step": number, **exchange.model_dump(include=kept)}
