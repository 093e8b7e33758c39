"""Reading boxes and points out of a vision-language model's text. Never raises, whatever the text.

Of the final answer (`hypernav.models.chat.unwrapping`) it reads, in this order:

- tags with areas, with the label before them where there is one: ``<ref>…</ref><box>[[…]]</box>``
  (InternVL), ``<box>x1 y1 x2 y2</box>`` (MiniCPM-V), ``<box>(x1,y1),(x2,y2)</box>`` (Qwen-VL),
  ``<|object_ref_start|>…<|box_start|>`` (Qwen2-VL), ``<|ref|>…<|det|>[[…]]`` (DeepSeek-VL2),
  ``<bbox>`` and ``<point>x y</point>`` (Seed), ``<point>[[x, y]]</point>`` (Embodied-R1);
- ``<point x= y= alt=>``, ``<points x1= y1= …>`` (Molmo, percent) and ``<points coords=>`` (Molmo2,
  thousandths, in triples of number, x and y behind the number of the image);
- ``<loc0123>`` (PaliGemma, rows first, 1024 bins) and ``<loc_123>`` (Florence-2, 1000 bins);
- JSON, bare, fenced or amid prose: lists, single objects and objects around lists, also if cut off
  or with single quotes and trailing commas; lists of numbers without keys;
- ``(x1,y1),(x2,y2)``, and an answer that is nothing but ``(x1,y1,x2,y2)``; of a family that is
  asked for points, ``(x,y)``.
"""

import json
import math
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.models.chat.answer_parsing import writable
from hypernav.models.chat.unwrapping import final_answer
from hypernav.models.chat.vlm_families import SIDES, VlmFamily

_MOST_CHARACTERS = 20_000
_MOST_ATTEMPTS = 400
_MOST_ITEMS = 200
_OVERSHOOT = 0.03  # share of the image by which a box may reach beyond it; it is clipped

_BOX_KEYS = ("bbox_2d", "box_2d", "bbox", "box", "bounding_box", "boundingbox", "bounding box")
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
_OPPOSITE_KEYS = ("top_left", "bottom_right")
_OUTLINE_KEYS = ("polygon", "outline", "vertices", "normalizedvertices", "normalized_vertices")
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
    r"(?P<tag><b?box>|<\|box_start\|>|<\|det\|>|<point>|<\|point_start\|>)"
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
_OPENING = re.compile(r"[\[{]")
_FLAT_OBJECT = re.compile(r"\{[^{}]{0,2000}\}")


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
        rows_first: Order of the numbers; None for the family's.
        side: The image's sides in the unit of the numbers; None for the family's.
        is_point: Whether it is a point.
    """

    numbers: Any
    label: str = ""
    score: float = 1.0
    rows_first: bool | None = None
    side: float | None = None
    is_point: bool = False


def read_grounding(
    text: str,
    family: VlmFamily,
    width: int,
    height: int,
    *,
    max_boxes: int = 10,
    min_side_px: float = 3.0,
) -> Grounding:
    """Read the boxes and points of an answer.

    Args:
        text: Text of the answer; anything.
        family: Family of the model, which tells its coordinates.
        width: Width of the image that the boxes are wanted in, pixels.
        height: Height of the same image, pixels.
        max_boxes: Largest number of boxes and points; further ones are rejected.
        min_side_px: Shortest side of a box, in the image's pixels; smaller boxes are rejected.
    """
    boxes: list[Detection] = []
    points: list[PointedAt] = []
    rejected: Counter[Rejection] = Counter()
    for item in _items(final_answer(text)[:_MOST_CHARACTERS], family):
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
    values = _numbers(item.numbers, 2 if item.is_point else 4)
    if isinstance(values, Rejection):
        return values
    if family.rows_first if item.rows_first is None else item.rows_first:
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
    items: list[_Item] = []
    for value in _json_values(text):
        items += _items_in(value, points=family.points)
        if len(items) >= _MOST_ITEMS:
            break
    return (items or _loose(text, family))[:_MOST_ITEMS]


def _areas(text: str) -> Iterator[_Item]:
    """Areas in tags; a label is of all areas that follow it at once."""
    label, end = "", 0
    for match in _AREA.finditer(text):
        if match["label"] is not None or not _BETWEEN_AREAS.fullmatch(text, end, match.start()):
            label = _one_line(match["label"] or "")
        end = match.end()
        is_point = "point" in match["tag"]
        for numbers in _in_groups(re.findall(_NUMBER, match["inside"]), 2 if is_point else 4):
            yield _Item(numbers, label, is_point=is_point)


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
    if match is not None:
        mended = re.sub(r",\s*([}\]])", r"\1", match[0].replace("'", '"'))
        try:
            return json.loads(mended), match.end()
        except (ValueError, RecursionError):
            pass
    return None, begin + 1


def _items_in(value: Any, *, points: bool) -> list[_Item]:
    """The boxes and points in a JSON value, however deep, in order."""
    items: list[_Item] = []
    waiting = [value]
    while waiting and len(items) < _MOST_ITEMS:
        one = waiting.pop()
        if isinstance(one, dict):
            found = _items_of(one)
            items += found
            if not found:
                waiting += [child for child in reversed(one.values()) if _is_container(child)]
        elif isinstance(one, list) and _looks_like_numbers(one, least=2 if points else 3):
            items.append(_Item(one, is_point=points and len(one) == 2))
        elif isinstance(one, list):
            waiting += [child for child in reversed(one) if _is_container(child)]
    return items


def _items_of(value: dict[Any, Any]) -> list[_Item]:
    """The box or the points that an object describes, if it does."""
    by_key = {str(key).strip().lower(): one for key, one in value.items()}
    label = next((by_key[key] for key in _LABEL_KEYS if isinstance(by_key.get(key), str)), "")
    score = next((_number(by_key[key]) for key in _SCORE_KEYS if key in by_key), 1.0)
    score = score if 0.0 <= score <= 1.0 else 1.0
    label = _one_line(label)
    for key in _BOX_KEYS:
        if key not in by_key:
            continue
        inner = by_key[key]
        if isinstance(inner, dict):
            return [replace(one, label=label, score=score) for one in _items_of(inner)]
        return [_Item(inner, label, score)]
    for corners in _CORNER_KEYS:
        if all(key in by_key for key in corners):
            return [_Item([by_key[key] for key in corners], label, score, rows_first=False)]
    for outline in (*(by_key.get(key) for key in _OUTLINE_KEYS), _opposite(by_key)):
        if (corners := _enclosing(outline)) is not None:
            return [_Item(corners, label, score, rows_first=False)]
    for key in _POINT_KEYS:
        if isinstance(by_key.get(key), list | str):
            inner = by_key[key]
            pairs = inner if inner and all(isinstance(one, list) for one in inner) else [inner]
            if key == "points" and any(isinstance(one, dict) for one in inner):
                break
            return [_Item(one, label, score, is_point=True) for one in pairs]
    if {"x", "y"} <= by_key.keys() and not by_key.keys() & _SIZE_KEYS:
        numbers = [by_key["x"], by_key["y"]]
        return [_Item(numbers, label, score, rows_first=False, is_point=True)]
    return []


def _opposite(by_key: dict[str, Any]) -> list[Any]:
    """Two corners, if an object has both."""
    corners = [by_key.get(key) for key in _OPPOSITE_KEYS]
    return corners if all(map(_is_container, corners)) else []


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


def _is_container(value: Any) -> bool:
    return isinstance(value, dict | list)


def _looks_like_numbers(value: list[Any], *, least: int) -> bool:
    """Whether a list may be a bare box, perhaps a broken one; "[2]" in prose is none."""
    return len(value) >= least and not any(isinstance(one, dict | list) for one in value)
