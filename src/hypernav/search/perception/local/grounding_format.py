"""Reading boxes and points out of a vision-language model's text. Never raises, whatever the text.

Of the final answer (`hypernav.search.models.chat.answer_parsing`) it reads, in this order:

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

import math
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.search.models.chat.answer_parsing import final_answer
from hypernav.search.models.chat.vlm_families import SIDES, VlmFamily
from hypernav.search.perception.local.grounding_json import (
    MOST_ITEMS,
    NUMBER,
    Item,
    enclosing,
    in_groups,
    json_items,
    number_of,
    one_line,
)

_PAIR = rf"\(\s*({NUMBER})\s*,\s*({NUMBER})\s*\)"
_TWO_PAIRS = re.compile(rf"{_PAIR}\s*,\s*{_PAIR}")
_ONE_PAIR = re.compile(_PAIR)
_FOUR = rf"[(<]\s*{NUMBER}(?:\s*,\s*{NUMBER}){{3}}\s*[)>]"
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
_XY = re.compile(rf"\bx(\d*)\s*=\s*\"\s*({NUMBER})\s*\"\s*y\1\s*=\s*\"\s*({NUMBER})\s*\"")
_COORDS = re.compile(r"\bcoords\s*=\s*\"([^\"]{0,4000})\"")
_ALT = re.compile(r"\balt\s*=\s*\"([^\"]{0,200})\"")
_BINS = re.compile(r"(?P<bins>(?:<loc\d{4}>)+)(?:<seg\d{3}>)*\s*(?P<label>[^<;]{0,80})")
_THOUSANDTHS = re.compile(r"(?P<label>[^<>]{0,80})(?P<bins>(?:<loc_\d{1,4}>)+)")

_MOST_CHARACTERS = 20_000
_OVERSHOOT = 0.03  # share of the image by which a box may reach beyond it; it is clipped

NEGATED = re.compile(
    r"(?:not?|non)[\s_-]|none$|n/a$|.*\b(?:not (?:visible|present|found|an?)|absent)\b",
    re.IGNORECASE,
)
"""A label that tells what is not there."""


def areas(text: str) -> Iterator[Item]:
    """Areas in tags; a label is of all areas that follow it at once."""
    label, end = "", 0
    for match in _AREA.finditer(text):
        if match["label"] is not None or not _BETWEEN_AREAS.fullmatch(text, end, match.start()):
            label = one_line(match["label"] or "")
        end = match.end()
        is_point = "point" in match["tag"]
        numbers = re.findall(NUMBER, match["inside"])
        if match["tag"] in {"<quad>", "<poly>"}:
            yield Item(enclosing(in_groups(numbers, 2)), label)
            continue
        for group in in_groups(numbers, 2 if is_point else 4):
            yield Item(group, label, is_point=is_point)


def pointed(text: str, family: VlmFamily) -> Iterator[Item]:
    """The points of Molmo and Molmo2, and those of other families in tags of the same form."""
    for match in _POINTS.finditer(text):
        attributes = match["attributes"]
        alt, coords = _ALT.search(attributes), _COORDS.search(attributes)
        label = one_line(alt[1] if alt else match["inside"] or "")
        if coords is None:
            side = SIDES["percent"] if family.name in {"molmo", "molmo2"} else None
            found = [list(one[1:]) for one in _XY.findall(attributes)]
        else:
            side, found = SIDES["thousandths"], list[list[str]]()
            for image in re.split(r"[;\t]", coords[1]):
                triples = in_groups(re.findall(NUMBER, image)[1:], 3)
                found += [triple[1:] if len(triple) == 3 else [] for triple in triples]
        for numbers in found:
            yield Item(numbers, label, rows_first=False, side=side, is_point=True)


def located(text: str) -> Iterator[Item]:
    """The location tokens of PaliGemma and Florence-2."""
    for pattern, side, rows_first in (
        (_BINS, SIDES["bins"], True),
        (_THOUSANDTHS, SIDES["thousandths"], False),
    ):
        for match in pattern.finditer(text):
            label = one_line(match["label"])
            for numbers in in_groups(re.findall(r"\d+", match["bins"]), 4):
                yield Item(numbers, label, rows_first=rows_first, side=side)


def loose(text: str, family: VlmFamily) -> list[Item]:
    """Numbers in round brackets."""
    if family.points:
        return [Item(list(pair), is_point=True) for pair in _ONE_PAIR.findall(text)]
    found = [list(numbers) for numbers in _TWO_PAIRS.findall(text)]
    if not found and _ONLY_FOURS.fullmatch(text):
        found = in_groups(re.findall(NUMBER, text), 4)
    return [Item(numbers) for numbers in found]


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
    item: Item, family: VlmFamily, width: int, height: int, min_side_px: float
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
        value = re.findall(NUMBER, value[:200])
    if isinstance(value, list) and len(value) == 2 and all(isinstance(v, list) for v in value):
        value = [*value[0], *value[1]]
    if not isinstance(value, list) or len(value) != count:
        return Rejection.NOT_FOUR if count == 4 else Rejection.NOT_TWO
    numbers = [number_of(one) for one in value]
    return numbers if all(map(math.isfinite, numbers)) else Rejection.NOT_A_NUMBER


def _items(text: str, family: VlmFamily) -> list[Item]:
    """Everything in a text that looks like a box or a point, in order."""
    marked = [*areas(text), *pointed(text, family), *located(text)]
    if marked:
        return marked[:MOST_ITEMS]
    items, is_told = json_items(text, points=family.points)
    return (items or ([] if is_told else loose(text, family)))[:MOST_ITEMS]
