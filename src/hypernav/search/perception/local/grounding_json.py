"""Boxes and points in the JSON of an answer, bare, fenced, amid prose, broken or cut off."""

import json
import math
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from hypernav.search.models.chat.answer_parsing import denies, writable

MOST_ITEMS = 200
"""Number of items of an answer that are looked at."""
NUMBER = r"[-+]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[eE][-+]?\d{1,4})?"
"""A number."""

_MOST_ATTEMPTS = 400
_BOX_KEYS = ("bbox_2d", "box_2d", "bbox", "box", "bounding_box", "boundingbox", "bounding box")
_AREA_KEY = re.compile(
    r"box|coord|rect|locat|position|point|object|item|instance|detect|predict|result|answer|found"
)
"""What is in the key of a list of boxes or points without keys of their own."""
_FORM_KEY = re.compile(r"(?:^|_)(?:format|mode|type)$")
_ORDER = re.compile(r"[xywhcltrbmina0-9]+")
"""What an order of numbers is written with."""
_FORMS = {
    **dict.fromkeys(("xyxy", "x1y1x2y2", "xminyminxmaxymax", "ltrb", "pascalvoc"), "xyxy"),
    **dict.fromkeys(("yxyx", "y1x1y2x2", "yminxminymaxxmax", "tlbr"), "yxyx"),
    **dict.fromkeys(("xywh", "ltwh", "coco", "xywidthheight"), "xywh"),
    **dict.fromkeys(("cxcywh", "xcycwh", "yolo"), "cxcywh"),
}
"""Orders of a box's numbers, by their spellings."""
_STATE = re.compile(r"visible|present|exist|found|detected")
_FALSE = (False, 0, "no", "false", "not found", "not visible", "not present", "absent")
_POINT_KEYS = ("point_2d", "point", "points")
_LABEL_KEYS = ("label", "name", "object", "category", "class", "description")
_SCORE_KEYS = ("score", "confidence", "probability")
_CORNER_KEYS = (
    ("x1", "y1", "x2", "y2"),
    ("x_min", "y_min", "x_max", "y_max"),
    ("xmin", "ymin", "xmax", "ymax"),
    ("left", "top", "right", "bottom"),
    ("x", "y", "x2", "y2"),
)
_SIZED_KEYS = ("left", "top", "width", "height")
_OPPOSITE_KEYS = (("topleft", "bottomright"), ("upperleft", "lowerright"), ("min", "max"))
_OUTLINE_KEYS = ("polygon", "outline", "corners", "vertices", "normalizedvertices")
_SIZE_KEYS = {"w", "h", "width", "height"}
_OPENING = re.compile(r"[\[{]")
_FLAT_OBJECT = re.compile(r"\{[^{}]{0,2000}\}")
_CUT_OBJECT = re.compile(r"\{[^{}\[\]]{0,500}\[[^{}\[\]]{0,500}\]")
_MENDS = (
    (re.compile(r",\s*([}\]])"), r"\1"),
    (re.compile(r"([{,]\s*)([A-Za-z_]\w{0,40})\s*:"), r'\1"\2":'),
    (re.compile(r"\bTrue\b"), "true"),
    (re.compile(r"\bFalse\b"), "false"),
    (re.compile(r"\bNone\b"), "null"),
)
"""Commas too many, keys without quotes, and Python's words."""


@dataclass(frozen=True)
class Item:
    """Something that looks like a box or a point: its numbers as they were written.

    Attributes:
        numbers: They are four of a box, two of a point.
        label: Label; empty if there is none.
        score: Score; 1 if there is none.
        rows_first: Whether rows come first; None for the family's order.
        form: Order of a box's numbers, one of `_FORMS`; empty if nothing says it.
        key: The key above, where none tells of a box or a point.
        is_denied: Whether it is said to be absent.
        side: The image's sides in the unit of the numbers; None for the family's.
        is_point: Whether it is a point.
    """

    numbers: Any
    label: str = ""
    score: float = 1.0
    rows_first: bool | None = None
    form: str = ""
    key: str = ""
    is_denied: bool = False
    side: float | None = None
    is_point: bool = False


def number_of(value: Any) -> float:
    """The value as a number; NaN if it is none."""
    if isinstance(value, str) and re.fullmatch(NUMBER, value.strip()):
        return float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def in_groups(numbers: list[str], size: int) -> list[list[str]]:
    """The numbers in groups; all in one, which is rejected, if they don't come out even."""
    if len(numbers) % size:
        return [numbers]
    return [numbers[k : k + size] for k in range(0, len(numbers), size)]


def one_line(label: str) -> str:
    """A label as one line of at most 80 characters."""
    return " ".join(writable(label).split())[:80]


def enclosing(outline: Any) -> list[float] | None:
    """The box around the corners of an outline: pairs, or objects with x and y; None if it is none.

    All coordinates are x first, as their keys say; a bare pair is taken alike.
    """
    if not isinstance(outline, list) or len(outline) < 2:
        return None
    pairs = [[one.get("x"), one.get("y")] if isinstance(one, dict) else one for one in outline]
    if not all(isinstance(pair, list) and len(pair) == 2 for pair in pairs):
        return None
    xs, ys = ([number_of(pair[k]) for pair in pairs] for k in (0, 1))
    if not all(map(math.isfinite, [*xs, *ys])):
        return None
    return [min(xs), min(ys), max(xs), max(ys)]


def json_items(text: str, *, points: bool) -> tuple[list[Item], bool]:
    """The boxes and points in the JSON of a text, and whether it has more to say than bare lists.

    Beside an object, or a list that is said to be empty, other lists are part of the prose.

    Args:
        text: Text of the answer.
        points: Whether a pair of numbers is a point.
    """
    values = _json_values(text)
    telling = [one for one in values if isinstance(one, dict) or not one or _holds_object(one)]
    items: list[Item] = []
    for value in telling or values:
        items += _items_in(value, points=points)
        if len(items) >= MOST_ITEMS:
            break
    return items, bool(telling)


def _holds_object(value: list[Any]) -> bool:
    return any(isinstance(one, dict) for one in value)


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
    if match is None:  # cut behind its numbers
        match = _CUT_OBJECT.match(text, begin)
    if match is not None:
        mended = match[0].replace("'", '"') + ("" if match[0].endswith("}") else "}")
        for pattern, right in _MENDS:
            mended = pattern.sub(right, mended)
        with suppress(ValueError, RecursionError):
            return json.loads(mended), match.end()
    return None, begin + 1


def _items_in(value: Any, *, points: bool) -> list[Item]:
    """The boxes and points in a JSON value, however deep, in order."""
    items: list[Item] = []
    waiting = [(value, "", "", False)]  # with the key above, the order of numbers, and denial
    while waiting and len(items) < MOST_ITEMS:
        one, key, form, is_denied = waiting.pop()
        if isinstance(one, dict):
            form = _form_told(one) or form
            is_denied = is_denied or _is_absent(one)
            above = _unknown(key)
            found = [
                replace(
                    item,
                    form=item.form or form,
                    is_denied=item.is_denied or is_denied,
                    key="" if item.label or not item.is_point else above,
                )
                for item in _items_of(one)
            ]
            items += found
            if not found:
                waiting += [
                    (child, str(name), form, is_denied or denies(str(name)))
                    for name, child in reversed(one.items())
                    if _is_container(child)
                ]
        elif isinstance(one, list) and _looks_like_numbers(one, least=2 if points else 3):
            unknown = _unknown(key)
            is_point = points and len(one) == 2
            items.append(
                Item(one, "", form=form, key=unknown, is_denied=is_denied, is_point=is_point)
            )
        elif isinstance(one, list):
            waiting += [
                (child, key, form, is_denied) for child in reversed(one) if _is_container(child)
            ]
    return items


def _unknown(key: str) -> str:
    """A key that tells of no area; empty if it does, or there is none."""
    return "" if not key or _AREA_KEY.search(key.lower()) else one_line(key)


def _form_told(value: dict[Any, Any]) -> str:
    """The order of numbers that an object tells of its boxes; empty if it tells none."""
    told = (
        one
        for key, one in value.items()
        if isinstance(one, str) and _FORM_KEY.search(str(key).lower())
    )
    known = (_FORMS.get(re.sub(r"[\W_]|pixels", "", one[:80].lower())) for one in told)
    return next((form for form in known if form), "")


def _is_absent(value: dict[Any, Any]) -> bool:
    """Whether an object says of a thing that it is not in the image."""
    by_key = {str(key).strip().lower(): one for key, one in value.items()}
    return by_key.get("absent") is True or any(
        _STATE.search(key) and not isinstance(one, dict | list) and _plain(one) in _FALSE
        for key, one in by_key.items()
    )


def _plain(value: Any) -> Any:
    return value.strip().lower() if isinstance(value, str) else value


def _items_of(value: dict[Any, Any]) -> list[Item]:
    """The box or the points that an object describes, if it does."""
    by_key = {str(key).strip().lower(): one for key, one in value.items()}
    label = next((by_key[key] for key in _LABEL_KEYS if isinstance(by_key.get(key), str)), "")
    score = next((number_of(by_key[key]) for key in _SCORE_KEYS if key in by_key), 1.0)
    score = score if 0.0 <= score <= 1.0 else 1.0
    label = one_line(label)
    for key, form in _box_keys(by_key):
        inner = by_key[key]
        if isinstance(inner, dict):
            return [replace(one, label=label, score=score) for one in _items_of(inner)]
        is_several = isinstance(inner, list) and inner and all(map(_is_box, inner))
        return [Item(one, label, score, form=form) for one in (inner if is_several else [inner])]
    for corners in _CORNER_KEYS:
        if all(key in by_key for key in corners):
            return [Item([by_key[key] for key in corners], label, score, form="xyxy")]
    if all(key in by_key for key in _SIZED_KEYS):
        return [Item([by_key[key] for key in _SIZED_KEYS], label, score, form="xywh")]
    for outline in (*(by_key.get(key) for key in _OUTLINE_KEYS), _opposite(by_key)):
        if (corners := enclosing(outline)) is not None:
            return [Item(corners, label, score, form="xyxy")]
    for key in _POINT_KEYS:
        if isinstance(by_key.get(key), list | str):
            inner = by_key[key]
            pairs = inner if inner and all(isinstance(one, list) for one in inner) else [inner]
            if key == "points" and any(isinstance(one, dict) for one in inner):
                break
            return [Item(one, label, score, is_point=True) for one in pairs]
    if {"x", "y"} <= by_key.keys():
        if sized := by_key.keys() & _SIZE_KEYS:  # some count from the middle, some from a corner
            numbers = [by_key[key] for key in ("x", "y", *sorted(sized, reverse=True))]
            return [Item(numbers, label, score, form="unknown")]
        numbers = [by_key["x"], by_key["y"]]
        return [Item(numbers, label, score, rows_first=False, is_point=True)]
    return []


def _box_keys(by_key: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """The keys of an object's box, the plain ones first, with the order of numbers that they tell.

    An addition that is no order, as in "bbox_conf" beside "bbox", tells nothing of a box unless it
    stands with numbers alone.
    """
    for key in _BOX_KEYS:
        if key in by_key:
            yield key, ""
    for key, value in by_key.items():
        if key in _BOX_KEYS or not _is_container(value):
            continue
        order = re.sub(r"bounding|b?box(?:es)?|coord(?:inate)?s?|location|[\W_]", "", key)
        if order in _FORMS:
            yield key, _FORMS[order]
        elif re.match(r"b?box(?:es)?(?:_|2d|$)", key):
            is_order = len(order) > 2 and order != "abs" and _ORDER.fullmatch(order)
            yield key, "unknown" if is_order else ""


def _opposite(by_key: dict[str, Any]) -> list[Any]:
    """Two corners, if an object has both."""
    plain = {re.sub(r"[\W_]", "", key): one for key, one in by_key.items()}
    for keys in _OPPOSITE_KEYS:
        corners = [plain.get(key) for key in keys]
        if all(map(_is_container, corners)):
            return corners
    return []


def _is_box(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 4


def _is_container(value: Any) -> bool:
    return isinstance(value, dict | list)


def _looks_like_numbers(value: list[Any], *, least: int) -> bool:
    """Whether a list may be a bare box, perhaps a broken one; "[2]" in prose is none."""
    return len(value) >= least and not any(isinstance(one, dict | list) for one in value)
