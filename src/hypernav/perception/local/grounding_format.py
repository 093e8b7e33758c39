"""Reading boxes out of the text of a vision-language model. Never raises, whatever the text.

It reads JSON, bare, fenced or amid prose: lists, single objects and objects around lists, also if
cut off or with single quotes and trailing commas; lists of numbers without keys; and Qwen2-VL's
``<|box_start|>(x1,y1),(x2,y2)<|box_end|>``.
"""

import json
import math
import re
from collections import Counter
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.models.chat.answer_parsing import without_thinking, writable
from hypernav.models.chat.vlm_families import VlmFamily

_MOST_CHARACTERS = 20_000
_MOST_ATTEMPTS = 400
_MOST_ITEMS = 200
_OVERSHOOT = 0.03  # share of the image by which a box may reach beyond it; it is clipped

_BOX_KEYS = ("bbox_2d", "box_2d", "bbox", "box", "bounding_box", "boundingbox", "bounding box")
_LABEL_KEYS = ("label", "name", "object", "category", "class", "description")
_SCORE_KEYS = ("score", "confidence", "probability")
_CORNER_KEYS = (
    ("x1", "y1", "x2", "y2"),
    ("x_min", "y_min", "x_max", "y_max"),
    ("xmin", "ymin", "xmax", "ymax"),
    ("left", "top", "right", "bottom"),
)
_NUMBER = r"[-+]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[eE][-+]?\d{1,4})?"
_PAIR = rf"\(\s*({_NUMBER})\s*,\s*({_NUMBER})\s*\)"
_MARKUP = re.compile(
    rf"(?:<\|object_ref_start\|>(?P<label>.{{0,200}}?)<\|object_ref_end\|>\s*)?"
    rf"(?:<\|box_start\|>)?\s*{_PAIR}\s*,\s*{_PAIR}",
    re.DOTALL,
)
_OPENING = re.compile(r"[\[{]")
_FLAT_OBJECT = re.compile(r"\{[^{}]{0,2000}\}")


class Rejection(StrEnum):
    """Reason for not taking a box."""

    NOT_FOUR = "not four numbers"
    NOT_A_NUMBER = "not a number"
    INVERTED = "inverted"
    OUTSIDE = "outside the picture"
    TOO_SMALL = "too small"
    DUPLICATE = "duplicate"
    TOO_MANY = "too many"


@dataclass(frozen=True)
class Grounding:
    """The boxes of an answer.

    Attributes:
        boxes: Usable boxes in pixels of the image, in the model's order; label empty and score 1
            where the model gave none.
        rejected: Number of the other boxes, by reason.
    """

    boxes: tuple[Detection, ...] = ()
    rejected: Counter[Rejection] = field(default_factory=Counter)


@dataclass(frozen=True)
class _Item:
    """Something that looks like a box: its numbers as they were written."""

    numbers: Any
    label: str = ""
    score: float = 1.0
    rows_first: bool | None = None


def read_grounding(
    text: str,
    family: VlmFamily,
    width: int,
    height: int,
    *,
    max_boxes: int = 10,
    min_side_px: float = 3.0,
) -> Grounding:
    """Read the boxes of an answer.

    Args:
        text: Text of the answer; anything.
        family: Family of the model, which tells its coordinates.
        width: Width of the image that the boxes are wanted in, pixels.
        height: Height of the same image, pixels.
        max_boxes: Largest number of boxes; further ones are rejected.
        min_side_px: Shortest side of a box, in the image's pixels; smaller boxes are rejected.
    """
    boxes: list[Detection] = []
    rejected: Counter[Rejection] = Counter()
    for item in _items(without_thinking(text[:_MOST_CHARACTERS])):
        found = _checked(item, family, width, height, min_side_px)
        if isinstance(found, Detection) and any(found.box == one.box for one in boxes):
            found = Rejection.DUPLICATE
        elif isinstance(found, Detection) and len(boxes) >= max_boxes:
            found = Rejection.TOO_MANY
        if isinstance(found, Detection):
            boxes.append(found)
        else:
            rejected[found] += 1
    return Grounding(tuple(boxes), rejected)


def _checked(
    item: _Item, family: VlmFamily, width: int, height: int, min_side_px: float
) -> Detection | Rejection:
    values = _numbers(item.numbers)
    if isinstance(values, Rejection):
        return values
    rows_first = family.rows_first if item.rows_first is None else item.rows_first
    a, b, c, d = values
    x_min, y_min, x_max, y_max = (b, a, d, c) if rows_first else (a, b, c, d)
    if x_min >= x_max or y_min >= y_max:
        return Rejection.INVERTED
    extent_x, extent_y = family.extent(width, height)
    near_x, near_y = _OVERSHOOT * extent_x, _OVERSHOOT * extent_y
    if min(x_min + near_x, y_min + near_y) < 0.0:
        return Rejection.OUTSIDE
    if x_max > extent_x + near_x or y_max > extent_y + near_y:
        return Rejection.OUTSIDE
    box = family.to_image(Box(x_min, y_min, x_max, y_max), width, height).clipped(width, height)
    if min(box.x_max - box.x_min, box.y_max - box.y_min) < min_side_px:
        return Rejection.TOO_SMALL
    return Detection(box, item.score, item.label)


def _numbers(value: Any) -> tuple[float, float, float, float] | Rejection:
    if isinstance(value, str):
        value = re.findall(_NUMBER, value[:200])
    if isinstance(value, list) and len(value) == 2 and all(isinstance(v, list) for v in value):
        value = [*value[0], *value[1]]
    if not isinstance(value, list) or len(value) != 4:
        return Rejection.NOT_FOUR
    numbers = [_number(one) for one in value]
    if not all(math.isfinite(number) for number in numbers):
        return Rejection.NOT_A_NUMBER
    return numbers[0], numbers[1], numbers[2], numbers[3]


def _number(value: Any) -> float:
    """The value as a number; NaN if it is none."""
    if isinstance(value, str) and re.fullmatch(_NUMBER, value.strip()):
        return float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _items(text: str) -> list[_Item]:
    """Everything in a text that looks like a box, in order."""
    items: list[_Item] = []
    for value in _json_values(text):
        items += _items_in(value)
        if len(items) >= _MOST_ITEMS:
            return items[:_MOST_ITEMS]
    return items or [
        _Item(list(match.group(2, 3, 4, 5)), (match["label"] or "").strip())
        for match in list(_MARKUP.finditer(text))[:_MOST_ITEMS]
    ]


def _json_values(text: str) -> list[Any]:
    """All JSON values of a text that are lists or objects, also within broken ones."""
    decoder = json.JSONDecoder()
    values: list[Any] = []
    at = 0
    for _ in range(_MOST_ATTEMPTS):
        begin = _OPENING.search(text, at)
        if begin is None:
            break
        try:
            value, at = decoder.raw_decode(text, begin.start())
        except (ValueError, RecursionError):
            value, at = _mended(text, begin.start())
        if value is not None:
            values.append(value)
    return values


def _mended(text: str, begin: int) -> tuple[Any, int]:
    """A broken object, read with quotes and commas corrected, and the offset to read on from."""
    match = _FLAT_OBJECT.match(text, begin)
    if match is not None:
        mended = re.sub(r",\s*([}\]])", r"\1", match[0].replace("'", '"'))
        try:
            return json.loads(mended), match.end()
        except (ValueError, RecursionError):
            pass
    return None, begin + 1


def _items_in(value: Any) -> list[_Item]:
    """The boxes in a JSON value, however deep, in order."""
    items: list[_Item] = []
    waiting = [value]
    while waiting and len(items) < _MOST_ITEMS:
        one = waiting.pop()
        if isinstance(one, dict):
            item = _item_of(one)
            if item is not None:
                items.append(item)
            else:
                waiting += [child for child in reversed(one.values()) if _is_container(child)]
        elif isinstance(one, list) and _looks_like_numbers(one):
            items.append(_Item(one))
        elif isinstance(one, list):
            waiting += [child for child in reversed(one) if _is_container(child)]
    return items


def _item_of(value: dict[Any, Any]) -> _Item | None:
    """The box that an object describes, if it does."""
    by_key = {str(key).strip().lower(): one for key, one in value.items()}
    label = next((by_key[key] for key in _LABEL_KEYS if isinstance(by_key.get(key), str)), "")
    score = next((_number(by_key[key]) for key in _SCORE_KEYS if key in by_key), 1.0)
    score = score if 0.0 <= score <= 1.0 else 1.0
    label = " ".join(writable(label).split())[:80]
    for key in _BOX_KEYS:
        if key not in by_key:
            continue
        inner = by_key[key]
        if isinstance(inner, dict):
            found = _item_of(inner)
            return None if found is None else _Item(found.numbers, label, score, found.rows_first)
        return _Item(inner, label, score)
    for corners in _CORNER_KEYS:
        if all(key in by_key for key in corners):
            return _Item([by_key[key] for key in corners], label, score, rows_first=False)
    return None


def _is_container(value: Any) -> bool:
    return isinstance(value, dict | list)


def _looks_like_numbers(value: list[Any]) -> bool:
    """Whether a list may be a bare box, perhaps a broken one; "[2]" in prose is none."""
    return len(value) >= 3 and not any(isinstance(one, dict | list) for one in value)
