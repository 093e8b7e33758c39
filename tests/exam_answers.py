"""Answers of an exam, made by hand."""

from hypernav.lab.exam.questions import Answered, Kind, Role, Shown

TRUE_BOX = (20.0, 20.0, 60.0, 80.0)
SIZE = (160, 120)


def answered(kind: Kind, stratum: str, number: int = 0, **values: object) -> Answered:
    """An answer; what isn't said is empty."""
    base = {"id": f"houses:1/0/{kind}/{stratum}/bed/{number}", "scene": "houses:1", "goal": "bed"}
    base |= {"things": []}
    return Answered.model_validate(
        base | {"kind": kind, "stratum": stratum, "score": 0.0, "image_size": SIZE} | values
    )


def boxed(
    stratum: str,
    box: tuple[float, ...] | None,
    score: float = 1.0,
    *,
    away_m: float = 2.0,
    true_box: tuple[float, ...] = TRUE_BOX,
    thing: int = 0,
    side: int = 0,
) -> Answered:
    """An answer with this box, or without any, about an image with one thing."""
    there = stratum in {"near", "far"}
    hit = box is not None and box[0] < 60.0
    others: dict[str, tuple[str, Role]] = {
        "look-alike": ("sofa", "alike"),
        "absent": ("oven", "other"),
    }
    name, role = others.get(stratum, ("bed", "goal"))
    is_boxed = hit if there else box is not None
    return answered(
        "boxes",
        stratum,
        true_boxes=[true_box] if there else [],
        boxes=[] if box is None else [box],
        raw_boxes=box is not None,
        probability=None if box is None else score,
        overlap=(1.0 if hit else 0.0) if there else None,
        conditions={"distance_m": away_m},
        things=[Shown(number=thing, name=name, role=role, boxed=is_boxed, view=(side, 2, False))],
    )


def checked(stratum: str, said: str | None, probability: float | None = None) -> Answered:
    """An answer to the question whether the goal is there."""
    right = ["yes" if stratum == "there" else "no"]
    return answered(
        "presence",
        stratum,
        chosen=said,
        right=right,
        probability=probability,
        options=["yes", "no"],
    )


def chose(option: int | None, costs: dict[str, float]) -> Answered:
    """An answer to the question which block to go to."""
    return answered(
        "block",
        "map",
        chosen=None if option is None else str(option),
        options=list(costs),
        costs=costs,
    )
