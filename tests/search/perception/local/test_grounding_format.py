import json
import random
from collections import Counter
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.geometry.boxes import Box
from hypernav.search.models.chat.vlm_families import FAMILIES, VlmFamily, family_named
from hypernav.search.perception.local.grounding_format import Grounding, Rejection, read_grounding

PIXELS = family_named("pixels")
WIDTH, HEIGHT = 640, 480


def read(text: str, family: VlmFamily = PIXELS, **settings) -> Grounding:
    return read_grounding(text, family, WIDTH, HEIGHT, **settings)


def boxes(text: str, family: VlmFamily = PIXELS) -> list[tuple[float, float, float, float]]:
    found = [one.box for one in read(text, family).boxes]
    return [(box.x_min, box.y_min, box.x_max, box.y_max) for box in found]


ONE = [(10.0, 20.0, 110.0, 220.0)]
TWO = [*ONE, (300.0, 5.0, 400.0, 300.0)]
ITEM = '{"bbox_2d": [10, 20, 110, 220], "label": "bed"}'
OTHER = '{"bbox_2d": [300, 5, 400, 300], "label": "bed"}'


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f"[{ITEM}]", ONE),
        (ITEM, ONE),
        (f"```json\n[{ITEM}, {OTHER}]\n```", TWO),
        (f"```\n{ITEM}\n{OTHER}\n```", TWO),
        (f"Sure, here they are: [{ITEM}, {OTHER}]. Anything else?", TWO),
        (f'{{"objects": [{ITEM}, {OTHER}]}}', TWO),
        (f'{{"result": {{"found": [{ITEM}]}}}}', ONE),
        (f"[{ITEM}, {OTHER}", TWO),
        (f"```json\n[{ITEM}, {OTHER[:20]}", ONE),
        ('[{"bbox_2d": [10, 20, 110, 220], "lab', ONE),
        ("[{'bbox_2d': [10, 20, 110, 220], 'label': 'bed'},]", ONE),
        ('[{"bbox_2d": [10, 20, 110, 220,], "label": "bed",},]', ONE),
        ("[10, 20, 110, 220]", ONE),
        ("[[10, 20, 110, 220], [300, 5, 400, 300]]", TWO),
        ('{"bed": [10, 20, 110, 220]}', ONE),
        ('{"box": "10, 20, 110, 220"}', ONE),
        ('{"bbox": ["10", "20", "110", "220"]}', ONE),
        ('{"bbox": [[10, 20], [110, 220]]}', ONE),
        ('{"x1": 10, "y1": 20, "x2": 110, "y2": 220}', ONE),
        ('{"box": {"xmin": 10, "ymin": 20, "xmax": 110, "ymax": 220}}', ONE),
        ("<|object_ref_start|>bed<|object_ref_end|><|box_start|>(10,20),(110,220)<|box_end|>", ONE),
        ("bed (10, 20), (110, 220)", ONE),
        ("<think>maybe [1, 2, 30, 40]</think>" + f"[{ITEM}]", ONE),
        (f"I see [2] beds: {ITEM} and {OTHER}", TWO),
    ],
)
def test_reads_boxes_however_they_are_wrapped(text: str, expected: list):
    assert boxes(text) == expected
    assert not read(text).rejected


ORDERS = {
    "xyxy": [10, 20, 110, 220],
    "yxyx": [20, 10, 220, 110],
    "xywh": [10, 20, 100, 200],
    "cxcywh": [60, 120, 100, 200],
}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(
    "item",
    [
        '{{"bbox_{0}": {1}}}',
        '{{"bbox": {1}, "format": "{0}"}}',
        '{{"box_format": "{0}", "boxes": [{1}]}}',
    ],
)
def test_numbers_are_taken_in_the_order_that_a_key_or_a_sibling_says(order: str, item: str):
    assert boxes(item.format(order, ORDERS[order])) == ONE


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{"point": [10, 20]}', [(10.0, 20.0)]),
        ('{"point": "10, 20"}', [(10.0, 20.0)]),
        ('{"points": [[10, 20], [300, 5]]}', [(10.0, 20.0), (300.0, 5.0)]),
        ('{"points": [[10, 20]]}', [(10.0, 20.0)]),
        ('{"points": [{"x": 10, "y": 20}, {"x": 300, "y": 5}]}', [(10.0, 20.0), (300.0, 5.0)]),
        ('{"points": []}', []),
        ("[10, 20]", [(10.0, 20.0)]),
        ("[[10, 20], [300, 5]]", [(10.0, 20.0), (300.0, 5.0)]),
        ("I see [2] of them", []),
    ],
)
def test_reads_points_however_they_are_grouped(text: str, expected: list):
    found = read(text, replace(PIXELS, points=True)).points
    assert [(one.x, one.y) for one in found] == expected


@pytest.mark.parametrize(
    ("text", "rejected"),
    [
        ("I see [2] beds", {}),
        ("between [2, 3] beds", {}),
        ("[10, 20, 110]", {Rejection.NOT_FOUR: 1}),
        ("[[10, 20, 110], [10, 20, 110, 220, 5]]", {Rejection.NOT_FOUR: 2}),
    ],
)
def test_three_bare_numbers_are_a_broken_box_and_fewer_are_prose(text: str, rejected: dict):
    assert read(text) == Grounding(rejected=Counter(rejected))


@pytest.mark.parametrize("text", ["", "[]", "```json\n[]\n```", "There is no bed.", "{}", "null"])
def test_no_box_is_no_box(text: str):
    grounding = read(text)
    assert (grounding.boxes, grounding.rejected) == ((), {})


@pytest.mark.parametrize(
    ("numbers", "reason"),
    [
        ("[10, 20, 110]", Rejection.NOT_FOUR),
        ("[10, 20, 110, 220, 5]", Rejection.NOT_FOUR),
        ("[]", Rejection.NOT_FOUR),
        ("7", Rejection.NOT_FOUR),
        ("null", Rejection.NOT_FOUR),
        ('"left"', Rejection.NOT_FOUR),
        ("[NaN, 20, 110, 220]", Rejection.NOT_A_NUMBER),
        ("[10, 20, Infinity, 220]", Rejection.NOT_A_NUMBER),
        ("[10, 20, 1e999, 220]", Rejection.NOT_A_NUMBER),
        ('[10, "wide", 110, 220]', Rejection.NOT_A_NUMBER),
        ("[10, true, 110, 220]", Rejection.NOT_A_NUMBER),
        ("[10, null, 110, 220]", Rejection.NOT_A_NUMBER),
        (f"[10, 20, 1{'0' * 400}, 220]", Rejection.NOT_A_NUMBER),
        ("[110, 20, 10, 220]", Rejection.INVERTED),
        ("[10, 220, 110, 20]", Rejection.INVERTED),
        ("[10, 20, 10, 220]", Rejection.INVERTED),
        ("[10, 20, 900, 220]", Rejection.OUTSIDE),
        ("[700, 20, 800, 220]", Rejection.OUTSIDE),
        ("[-200, 20, 110, 220]", Rejection.OUTSIDE),
        ("[10, 20, 110, 600]", Rejection.OUTSIDE),  # as wide as the image, but not as high
        ("[10, -100, 110, 220]", Rejection.OUTSIDE),
        ("[10, 20, 11, 220]", Rejection.TOO_SMALL),
        ("[300, 5, 400, 300]", Rejection.DUPLICATE),
    ],
)
def test_a_bad_box_is_rejected_alone_and_counted(numbers: str, reason: Rejection):
    text = f'[{OTHER}, {{"bbox_2d": {numbers}, "label": "bed"}}, {ITEM}]'
    grounding = read(text)
    assert [one.box for one in grounding.boxes] == [Box(*TWO[1]), Box(*ONE[0])]
    assert grounding.rejected == {reason: 1}


def test_a_small_overshoot_is_clipped():
    assert boxes('{"bbox_2d": [-5, 20, 650, 485]}') == [(0.0, 20.0, 640.0, 480.0)]
    points = read('{"points": [[-5, 485], [650, -5]]}', replace(PIXELS, points=True)).points
    assert [(one.x, one.y) for one in points] == [(0.0, 479.0), (639.0, 0.0)]  # the last pixels


def test_a_repeating_model_gives_one_box():
    grounding = read("[" + ", ".join([ITEM] * 50))
    assert len(grounding.boxes) == 1
    assert grounding.rejected == {Rejection.DUPLICATE: 49}


def test_too_many_boxes():
    text = json.dumps([{"bbox_2d": [x, 0, x + 20, 50]} for x in range(30)])
    grounding = read(text, max_boxes=4)
    assert [one.box.x_min for one in grounding.boxes] == [0.0, 1.0, 2.0, 3.0]
    assert grounding.rejected == {Rejection.TOO_MANY: 26}


def test_a_label_in_tags_is_of_all_areas_that_follow_it_at_once():
    areas = [f"<box>({x},20),({x + 40},220)</box>" for x in range(0, 500, 100)]
    first, second, third, fourth, fifth = areas
    text = f"A <ref>bed</ref>{first}, {second} <ref>sofa</ref>{third} beside {fourth}{fifth}"
    assert [one.label for one in read(text).boxes] == ["bed", "bed", "sofa", "", ""]


def test_labels_scores_and_order_are_the_models():
    text = (
        '[{"bbox_2d": [1, 2, 30, 40], "label": "window\\n curtain", "score": 0.25},'
        ' {"label": "sofa", "bbox_2d": [5, 6, 70, 80], "confidence": 7}]'
    )
    first, second = read(text).boxes
    assert (first.label, first.score) == ("window curtain", 0.25)
    assert (second.label, second.score) == ("sofa", 1.0)


@pytest.mark.parametrize(
    ("family", "numbers"),
    [
        ("qwen2.5-vl", "[322, 238, 644, 476]"),
        ("qwen3-vl", "[500, 500, 1000, 1000]"),
        ("gemini", "[500, 500, 1000, 1000]"),
        ("unit", "[0.5, 0.5, 1.0, 1.0]"),
        ("pixels", "[320, 240, 640, 480]"),
    ],
)
def test_coordinate_spaces(family: str, numbers: str):
    found = boxes(f'{{"box": {numbers}}}', family_named(family))
    assert found == [pytest.approx((320.0, 240.0, 640.0, 480.0))]


def test_rows_first():
    text = '[{"box_2d": [0, 500, 250, 1000], "label": "bed"}]'
    assert boxes(text, family_named("gemini")) == [pytest.approx((320.0, 0.0, 640.0, 120.0))]


def test_pixels_where_thousandths_are_expected_do_not_pass_unseen():
    """A right box in the wrong space is rejected if it leaves the space, and so it is counted."""
    assert read('{"bbox_2d": [900, 600, 1200, 700]}', family_named("qwen3-vl")).rejected


@given(
    st.sampled_from(sorted(FAMILIES)),
    st.integers(0, 600),
    st.integers(0, 440),
    st.integers(8, 640),
    st.integers(8, 480),
)
def test_what_a_family_would_say_is_read_back(name: str, x: int, y: int, w: int, h: int):
    family = family_named(name)
    box = Box(float(x), float(y), float(min(x + w, WIDTH)), float(min(y + h, HEIGHT)))
    said = family.from_image(box, WIDTH, HEIGHT)
    numbers = [said.x_min, said.y_min, said.x_max, said.y_max]
    if family.rows_first:
        numbers = [numbers[1], numbers[0], numbers[3], numbers[2]]
    (found,) = read(json.dumps([{family.box_key: numbers, "label": "bed"}]), family).boxes
    assert found.box.iou(box) > 0.999


def malformed_answers(count: int) -> list[str]:
    """Answers that models really give, broken at random positions in random manners."""
    rng = random.Random(20260101)
    pieces = [
        *(
            "[",
            "]",
            "{",
            "}",
            "(",
            ")",
            ",",
            ":",
            '"',
            "'",
            "`",
            "```json",
            "\n",
            " ",
            "\\",
            "\x00",
        ),
        *("bbox_2d", '"bbox_2d":', '"label": "bed"', "null", "true", "NaN", "-Infinity", "1e999"),
        *("<|box_start|>", "<|box_end|>", "(1,2)", "<think>", "</think>", "é", "\ud800", "\u2028"),
        *("1", "-5", "640", "0.5", "9" * 400, "[[[[", "]]]]", '{"a":' * 50, "x1", '"y2": 3'),
    ]
    good = [
        f"```json\n[{ITEM}, {OTHER}]\n```",
        f"[{ITEM}, {OTHER}]",
        "<|object_ref_start|>bed<|object_ref_end|><|box_start|>(10,20),(110,220)<|box_end|>",
        "[[10, 20, 110, 220], [300, 5, 400, 300]]",
        '{"x1": 10, "y1": 20, "x2": 110, "y2": 220}',
    ]
    answers = []
    for number in range(count):
        text = (
            rng.choice(good) if number % 3 else "".join(rng.choices(pieces, k=rng.randint(1, 60)))
        )
        for _ in range(rng.randint(1, 8)):
            at, length = rng.randint(0, len(text)), rng.randint(0, 12)
            middle = rng.choice(["", rng.choice(pieces), text[at : at + length] * 3])
            text = text[:at] + middle + text[at + rng.randint(0, length) :]
        answers.append(text[: rng.randint(0, len(text))] if number % 4 == 0 else text)
    return answers


@pytest.mark.slow
def test_ten_thousand_malformed_answers_never_raise_and_never_leave_the_image():
    families = list(FAMILIES.values())
    usable = 0
    for number, text in enumerate(malformed_answers(10_000)):
        grounding = read(text, families[number % len(families)])
        for one in grounding.boxes:
            assert 0.0 <= one.box.x_min < one.box.x_max <= WIDTH
            assert 0.0 <= one.box.y_min < one.box.y_max <= HEIGHT
            assert 0.0 <= one.score <= 1.0
        usable += bool(grounding.boxes)
    assert 500 < usable < 9_500


@given(st.text(max_size=300), st.sampled_from(sorted(FAMILIES)))
def test_any_text_at_all(text: str, family: str):
    read(text, family_named(family))


@pytest.mark.parametrize(
    "text",
    [
        "[" * 100_000,
        '{"a":' * 50_000,
        "(1,2),(" * 20_000,
        "(" + "1" * 100_000,
        '{"bbox_2d": [' * 9_000,
    ],
)
def test_monstrous_answers_hang_nothing(text: str):
    read(text)
