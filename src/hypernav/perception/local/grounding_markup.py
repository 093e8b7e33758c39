"""Boxes and points in the markup of models: tags, location tokens, numbers in round brackets."""

import re
from collections.abc import Iterator

from hypernav.models.chat.vlm_families import SIDES, VlmFamily
from hypernav.perception.local.grounding_items import NUMBER, Item, enclosing, in_groups, one_line

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
