"""Reading boxes and points out of a vision-language model's text. Never raises, whatever the text.

Of the final answer (`hypernav.models.chat.unwrapping`) it reads, in this order:

- tags with areas, with the label before them where there is one: ``<ref>…</ref><box>[[…]]</box>``
  (InternVL), ``<box>x1 y1 x2 y2</box>`` (MiniCPM-V), ``<box>(x1,y1),(x2,y2)</box>`` (Qwen-VL),
  ``<|object_ref_start|>…<|box_start|>`` (Qwen2-VL), ``<|ref|>…<|det|>[[…]]`` (DeepSeek-VL2),
  ``<bbox>`` and ``<point>x y</point>`` (Seed), ``<point>[[x, y]]</point>`` (Embodied-R1),
  ``<quad>`` and ``<poly>`` (Qwen-VL), whose corners a box encloses;
- ``<point x= y= alt=>``, ``<points x1= y1= …>`` (Molmo, percent) and ``<points coords=>`` (Molmo2,
  thousandths, in triples of number, x and y behind the number of the image);
- ``<loc0123>`` (PaliGemma, rows first, 1024 bins) and ``<loc_123>`` (Florence-2, 1000 bins);
- JSON, bare, fenced or amid prose: lists, single objects and objects around lists, also if cut off
  or with single quotes and trailing commas; lists of numbers without keys. The order of a box's
  numbers is the family's unless a key or a sibling says it (``bbox_xywh``, ``"format": "xywh"``).
  Numbers under a key that is neither a box's nor the name of what was asked for are no box, and
  neither is what is said to be absent (``"visible": false``, ``"label": "not a bed"``);
- ``(x1,y1),(x2,y2)``, and an answer that is nothing but ``(x1,y1,x2,y2)``; of a family that is
  asked for points, ``(x,y)``.
"""

import json
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.models.chat.answer_parsing import denies, writable
from hypernav.models.chat.unwrapping import final_answer
from hypernav.models.chat.vlm_families import SIDES, VlmFamily

_MOST_CHARACTERS = 20_000
_MOST_ATTEMPTS = 400
_MOST_ITEMS = 200
_OVERSHOOT = 0.03  # share of the image by which a box may reach beyond it; it is clipped

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
_NUMBER = r"[-+]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:[eE][-+]?\d{1,4})?"
_PAIR = rf"\(\s*({_NUMBER})\s*,\s*({_NUMBER})\s*\)"
_TWO_PAIRS = re.compile(rf"{_PAIR}\s*,\s*{_PAIR}")
_ONE_PAIR = re.compile(_PAIR)
_FOUR = rf"[(<]\s*{_NUMBER}(?:\s*,\s*{_NUMBER}){{3}}\s*[)>]"
_ONLY_FOURS = re.compile(rf"\s*(?:{_FOUR}[\s,;]*){{1,64}}")
_AREA = re.compile(
    r"(?:(?:<ref>|<\|object_ref_start\|>|<\|ref\|>)(?P<label>[^<]{0,200})"
    r"(?:</ref>|<\|object_ref_end\|>|<\|/ref\|>)\s*)?"
    r"(?P<tag><b?box>|<\|box_start\|>|<\|det\|>|<point>|<\|point_start\|>|<quad>|<poly>)"
    r"(?P<inside>[\s\[(]{0,20}[-+.\d][^<]{0,2000})"
)
_BETWEEN_AREAS = re.compile(r"(?:</?[\w|/]{1,20}>|[\s,;])*")
_POINTS = re.compile(
    r"<points?\s(?P<attributes>[^<>]{1,4000}?)/?>(?:(?P<inside>[^<]{0,200})</points?>)?"
)
_XY = re.compile(rf"\bx(\d*)\s*=\s*\"\s*({_NUMBER})\s*\"\s*y\1\s*=\s*\"\s*({_NUMBER})\s*\"")
_COORDS = re.compile(r"\bcoords\s*=\s*\"([^\"]{0,4000})\"")
_ALT = re.compile(r"\balt\s*=\s*\"([^\"]{0,200})\"")
_BINS = re.compile(r"(?P<bins>(?:<loc\d{4}>)+)(?:<seg\d{3}>)*\s*(?P<label>[^<;]{0,80})")
_THOUSANDTHS = re.compile(r"(?P<label>[^<>]{0,80})(?P<bins>(?:<loc_\d{1,4}>)+)")
NEGATED = re.compile(
    r"(?:not?|non)[\s_-]|none$|n/a$|.*\b(?:not (?:visible|present|found|an?)|absent)\b",
    re.IGNORECASE,
)
"""A label that tells what is not there."""
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


class Rejection(StrEnum):
    """Reason for not taking a box or a point."""

    NOT_FOUR = "not four numbers"
    NOT_TWO = "not two numbers"
    NOT_A_NUMBER = "not a number"
    INVERTED = "inverted"
    OUTSIDE = "outside the picture"
    TOO_SMALL = "too small"
    DUPLICATE = "duplicate"
    TOO_MANY = "too many"
    UNKNOWN_FORM = "in an order of numbers that it doesn't say"
    UNKNOWN_KEY = "under a key that is no box's"
    DENIED = "said to be absent"


@dataclass(frozen=True)
class PointedAt:
    """A point on an object, in pixels of the image; the label is empty where there was none."""

    x: float
    y: float
    label: str = ""


@dataclass(frozen=True)
class Grounding:
    """The boxes and points of an answer.

    Attributes:
        boxes: Usable boxes in pixels of the image, in the model's order; label empty and score 1
            where the model gave none.
        points: Usable points, in the model's order.
        rejected: Number of the other boxes and points, by reason.
    """

    boxes: tuple[Detection, ...] = ()
    points: tuple[PointedAt, ...] = ()
    rejected: Counter[Rejection] = field(default_factory=Counter)


@dataclass(frozen=True)
class _Item:
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


def read_grounding(
    text: str,
    family: VlmFamily,
    width: int,
    height: int,
    *,
    names_goal: Callable[[str], bool] = lambda key: True,
    max_boxes: int = 10,
    min_side_px: float = 3.0,
) -> Grounding:
    """Read the boxes and points of an answer.

    Args:
        text: Text of the answer; anything.
        family: Family of the model, which tells its coordinates.
        width: Width of the image that the boxes are wanted in, pixels.
        height: Height of the same image, pixels.
        names_goal: Whether a name means what was asked for: a key as in
            ``{"bed": [10, 20, 110, 220]}``, or a label that begins with "no" or "not".
        max_boxes: Largest number of boxes and points; further ones are rejected.
        min_side_px: Shortest side of a box, in the image's pixels; smaller boxes are rejected.
    """
    boxes: list[Detection] = []
    points: list[PointedAt] = []
    rejected: Counter[Rejection] = Counter()
    for item in _items(final_answer(text)[:_MOST_CHARACTERS], family):
        if item.key and names_goal(item.key):
            item = replace(item, label=item.key, key="")
        if NEGATED.match(item.label) and not names_goal(item.label):
            item = replace(item, is_denied=True)
        found = _checked(item, family, width, height, min_side_px)
        if isinstance(found, Rejection):
            rejected[found] += 1
        elif _is_known(found, boxes, points):
            rejected[Rejection.DUPLICATE] += 1
        elif len(boxes) + len(points) >= max_boxes:
            rejected[Rejection.TOO_MANY] += 1
        elif isinstance(found, Detection):
            boxes.append(found)
        else:
            points.append(found)
    return Grounding(tuple(boxes), tuple(points), rejected)


def _is_known(
    found: Detection | PointedAt, boxes: list[Detection], points: list[PointedAt]
) -> bool:
    if isinstance(found, Detection):
        return any(found.box == one.box for one in boxes)
    return any((found.x, found.y) == (one.x, one.y) for one in points)


def _checked(
    item: _Item, family: VlmFamily, width: int, height: int, min_side_px: float
) -> Detection | PointedAt | Rejection:
    if item.key or item.is_denied:
        return Rejection.DENIED if item.is_denied else Rejection.UNKNOWN_KEY
    values = _numbers(item.numbers, 2 if item.is_point else 4)
    if isinstance(values, Rejection):
        return values
    if item.form == "unknown":
        return Rejection.UNKNOWN_FORM
    if item.form in {"xywh", "cxcywh"}:
        x, y, w, h = values
        x, y = (x - w / 2.0, y - h / 2.0) if item.form == "cxcywh" else (x, y)
        values = [x, y, x + w, y + h]
    elif item.form == "yxyx" or (
        not item.form and (family.rows_first if item.rows_first is None else item.rows_first)
    ):
        values = [values[k ^ 1] for k in range(len(values))]
    extent = family.extent(width, height) if item.side is None else (item.side, item.side)
    near = _OVERSHOOT * extent[0], _OVERSHOOT * extent[1]
    if not item.is_point and (values[0] >= values[2] or values[1] >= values[3]):
        return Rejection.INVERTED
    if any(
        not -near[k % 2] <= value <= extent[k % 2] + near[k % 2] for k, value in enumerate(values)
    ):
        return Rejection.OUTSIDE
    size = width, height
    pixels = [value * size[k % 2] / extent[k % 2] for k, value in enumerate(values)]
    if item.is_point:
        x, y = (min(max(value, 0.0), side - 1.0) for value, side in zip(pixels, size, strict=True))
        return PointedAt(x, y, item.label)
    box = Box(*pixels).clipped(width, height)
    if min(box.x_max - box.x_min, box.y_max - box.y_min) < min_side_px:
        return Rejection.TOO_SMALL
    return Detection(box, item.score, item.label)


def _numbers(value: Any, count: int) -> list[float] | Rejection:
    if isinstance(value, str):
        value = re.findall(_NUMBER, value[:200])
    if isinstance(value, list) and len(value) == 2 and all(isinstance(v, list) for v in value):
        value = [*value[0], *value[1]]
    if not isinstance(value, list) or len(value) != count:
        return Rejection.NOT_FOUR if count == 4 else Rejection.NOT_TWO
    numbers = [_number(one) for one in value]
    return numbers if all(map(math.isfinite, numbers)) else Rejection.NOT_A_NUMBER


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


def _items(text: str, family: VlmFamily) -> list[_Item]:
    """Everything in a text that looks like a box or a point, in order."""
    marked = [*_areas(text), *_pointed(text, family), *_located(text)]
    if marked:
        return marked[:_MOST_ITEMS]
    values = _json_values(text)
    # Beside an object, or a list that is said to be empty, other lists are part of the prose.
    telling = [one for one in values if isinstance(one, dict) or not one or _holds_object(one)]
    items: list[_Item] = []
    for value in telling or values:
        items += _items_in(value, points=family.points)
        if len(items) >= _MOST_ITEMS:
            break
    return (items or ([] if telling else _loose(text, family)))[:_MOST_ITEMS]


def _holds_object(value: list[Any]) -> bool:
    return any(isinstance(one, dict) for one in value)


def _areas(text: str) -> Iterator[_Item]:
    """Areas in tags; a label is of all areas that follow it at once."""
    label, end = "", 0
    for match in _AREA.finditer(text):
        if match["label"] is not None or not _BETWEEN_AREAS.fullmatch(text, end, match.start()):
            label = _one_line(match["label"] or "")
        end = match.end()
        is_point = "point" in match["tag"]
        numbers = re.findall(_NUMBER, match["inside"])
        if match["tag"] in {"<quad>", "<poly>"}:
            yield _Item(_enclosing(_in_groups(numbers, 2)), label)
            continue
        for group in _in_groups(numbers, 2 if is_point else 4):
            yield _Item(group, label, is_point=is_point)


def _pointed(text: str, family: VlmFamily) -> Iterator[_Item]:
    """The points of Molmo and Molmo2, and those of other families in tags of the same form."""
    for match in _POINTS.finditer(text):
        attributes = match["attributes"]
        alt, coords = _ALT.search(attributes), _COORDS.search(attributes)
        label = _one_line(alt[1] if alt else match["inside"] or "")
        if coords is None:
            side = SIDES["percent"] if family.name in {"molmo", "molmo2"} else None
            found = [list(one[1:]) for one in _XY.findall(attributes)]
        else:
            side, found = SIDES["thousandths"], list[list[str]]()
            for image in re.split(r"[;\t]", coords[1]):
                triples = _in_groups(re.findall(_NUMBER, image)[1:], 3)
                found += [triple[1:] if len(triple) == 3 else [] for triple in triples]
        for numbers in found:
            yield _Item(numbers, label, rows_first=False, side=side, is_point=True)


def _located(text: str) -> Iterator[_Item]:
    """The location tokens of PaliGemma and Florence-2."""
    for pattern, side, rows_first in (
        (_BINS, SIDES["bins"], True),
        (_THOUSANDTHS, SIDES["thousandths"], False),
    ):
        for match in pattern.finditer(text):
            label = _one_line(match["label"])
            for numbers in _in_groups(re.findall(r"\d+", match["bins"]), 4):
                yield _Item(numbers, label, rows_first=rows_first, side=side)


def _loose(text: str, family: VlmFamily) -> list[_Item]:
    """Numbers in round brackets."""
    if family.points:
        return [_Item(list(pair), is_point=True) for pair in _ONE_PAIR.findall(text)]
    found = [list(numbers) for numbers in _TWO_PAIRS.findall(text)]
    if not found and _ONLY_FOURS.fullmatch(text):
        found = _in_groups(re.findall(_NUMBER, text), 4)
    return [_Item(numbers) for numbers in found]


def _in_groups(numbers: list[str], size: int) -> list[list[str]]:
    """The numbers in groups; all in one, which is rejected, if they don't come out even."""
    if len(numbers) % size:
        return [numbers]
    return [numbers[k : k + size] for k in range(0, len(numbers), size)]


def _one_line(label: str) -> str:
    return " ".join(writable(label).split())[:80]


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


def _items_in(value: Any, *, points: bool) -> list[_Item]:
    """The boxes and points in a JSON value, however deep, in order."""
    items: list[_Item] = []
    waiting = [(value, "", "", False)]  # with the key above, the order of numbers, and denial
    while waiting and len(items) < _MOST_ITEMS:
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
                _Item(one, "", form=form, key=unknown, is_denied=is_denied, is_point=is_point)
            )
        elif isinstance(one, list):
            waiting += [
                (child, key, form, is_denied) for child in reversed(one) if _is_container(child)
            ]
    return items


def _unknown(key: str) -> str:
    """A key that tells of no area; empty if it does, or there is none."""
    return "" if not key or _AREA_KEY.search(key.lower()) else _one_line(key)


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


def _items_of(value: dict[Any, Any]) -> list[_Item]:
    """The box or the points that an object describes, if it does."""
    by_key = {str(key).strip().lower(): one for key, one in value.items()}
    label = next((by_key[key] for key in _LABEL_KEYS if isinstance(by_key.get(key), str)), "")
    score = next((_number(by_key[key]) for key in _SCORE_KEYS if key in by_key), 1.0)
    score = score if 0.0 <= score <= 1.0 else 1.0
    label = _one_line(label)
    for key, form in _box_keys(by_key):
        inner = by_key[key]
        if isinstance(inner, dict):
            return [replace(one, label=label, score=score) for one in _items_of(inner)]
        is_several = isinstance(inner, list) and inner and all(map(_is_box, inner))
        return [_Item(one, label, score, form=form) for one in (inner if is_several else [inner])]
    for corners in _CORNER_KEYS:
        if all(key in by_key for key in corners):
            return [_Item([by_key[key] for key in corners], label, score, form="xyxy")]
    if all(key in by_key for key in _SIZED_KEYS):
        return [_Item([by_key[key] for key in _SIZED_KEYS], label, score, form="xywh")]
    for outline in (*(by_key.get(key) for key in _OUTLINE_KEYS), _opposite(by_key)):
        if (corners := _enclosing(outline)) is not None:
            return [_Item(corners, label, score, form="xyxy")]
    for key in _POINT_KEYS:
        if isinstance(by_key.get(key), list | str):
            inner = by_key[key]
            pairs = inner if inner and all(isinstance(one, list) for one in inner) else [inner]
            if key == "points" and any(isinstance(one, dict) for one in inner):
                break
            return [_Item(one, label, score, is_point=True) for one in pairs]
    if {"x", "y"} <= by_key.keys():
        if sized := by_key.keys() & _SIZE_KEYS:  # some count from the middle, some from a corner
            numbers = [by_key[key] for key in ("x", "y", *sorted(sized, reverse=True))]
            return [_Item(numbers, label, score, form="unknown")]
        numbers = [by_key["x"], by_key["y"]]
        return [_Item(numbers, label, score, rows_first=False, is_point=True)]
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


def _enclosing(outline: Any) -> list[float] | None:
    """The box around the corners of an outline: pairs, or objects with x and y; None if it is none.

    All coordinates are x first, as their keys say; a bare pair is taken alike.
    """
    if not isinstance(outline, list) or len(outline) < 2:
        return None
    pairs = [[one.get("x"), one.get("y")] if isinstance(one, dict) else one for one in outline]
    if not all(isinstance(pair, list) and len(pair) == 2 for pair in pairs):
        return None
    xs, ys = ([_number(pair[k]) for pair in pairs] for k in (0, 1))
    if not all(map(math.isfinite, [*xs, *ys])):
        return None
    return [min(xs), min(ys), max(xs), max(ys)]


def _is_box(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 4


def _is_container(value: Any) -> bool:
    return isinstance(value, dict | list)


def _looks_like_numbers(value: list[Any], *, least: int) -> bool:
    """Whether a list may be a bare box, perhaps a broken one; "[2]" in prose is none."""
    return len(value) >= least and not any(isinstance(one, dict | list) for one in value)
