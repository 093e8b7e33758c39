import math
from collections.abc import Iterator
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from hypernav.app.build.env import ObjectNavConfig
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered
from hypernav.lab.evaluation.ablation.switches import values_by_field
from hypernav.simulator.worlds.drawing.renderer import RenderConfig


def numbers(model: type[BaseModel]) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Name and bounds of every number in a configuration, from its JSON schema."""
    schema = model.model_json_schema()

    def walk(part: dict[str, Any], name: str) -> Iterator[tuple[str, tuple[Any, Any]]]:
        if "$ref" in part:
            part = schema["$defs"][part["$ref"].rpartition("/")[2]]
        if part.get("type") in ("integer", "number"):
            low = part.get("minimum", part.get("exclusiveMinimum"))
            high = part.get("maximum", part.get("exclusiveMaximum"))
            yield name, (low, high)
        for key, inner in part.get("properties", {}).items():
            yield from walk(inner, f"{name}.{key}" if name else key)
        for inner in (*part.get("anyOf", ()), *part.get("prefixItems", ())):
            yield from walk(inner, name)
        if isinstance(part.get("items"), dict):
            yield from walk(part["items"], name)

    return walk(schema, "")


def with_value(name, value):
    values = preset("default").model_dump()
    *sections, key = name.split(".")
    section_values = values
    for section in sections:
        section_values = section_values[section]
    section_values[key] = value
    return HyPerNavConfig.model_validate(values)


NUMBERS = dict(numbers(HyPerNavConfig))


def test_the_walk_finds_the_numbers():
    assert {"embodiment.body.radius_m", "search.patience_steps", "chat.seed"} <= set(NUMBERS)
    assert len(NUMBERS) > 80


@pytest.mark.parametrize("model", [HyPerNavConfig, RenderConfig, ObjectNavConfig])
def test_every_number_has_a_lower_and_an_upper_bound(model):
    assert {name: bounds for name, bounds in numbers(model) if None in bounds} == {}


@pytest.mark.parametrize("name", NUMBERS)
def test_what_is_out_of_bounds_or_no_number_is_refused(name):
    low, high = NUMBERS[name]
    for nonsense in (math.nan, math.inf, -math.inf, low - 1, high + 1):
        with pytest.raises(ValidationError):
            with_value(name, nonsense)


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("local.erosion_px=0", "greater than or equal to 1"),
        ("local.erosion_px=4", "odd side"),
        ("local.dilation_kernel=2", "odd side"),
        ("planning.margin_m=-0.1", "greater than or equal to 0"),
        ("search.patience_steps=-1", "greater than or equal to 0"),
        ("embodiment.body.radius_m=.nan", "finite"),
        ("embodiment.body.max_step_m=1", "max_step_m must be below height_m"),
        ("embodiment.camera.min_depth_m=6", "min_depth_m must be below max_depth_m"),
        ("embodiment.motion.turn_angle_deg=25", "divide a circle"),
        ("embodiment.body.height_m=3", "larger mapping.voxel_height_m"),
        ("embodiment.camera.width=1000000", "equal to 8192, got 1000000 .images must fit"),
        ("mapping.cell_size_m=0.0001", r"equal to 0.01, got 0.0001 .maps must fit"),
        ("overview.image_px=1000000", "equal to 4096, got 1000000 .images must fit"),
        (
            "embodiment.motion.forward_m=1e9",
            "less than or equal to 5, .* .metres, within the sizes",
        ),
        ("embodiment.motion.turn_angle_deg=.nan", "finite number, got nan .degrees, at most"),
        ("embodiment.camera.max_depth_m=.inf", "finite number, got inf .metres, within the sizes"),
        ("world.cell_m=1e-6", "equal to 0.01, got .* .maps must fit"),
    ],
)
def test_nonsense_is_refused_with_the_reason(assignment, words):
    with pytest.raises(ConfigError, match=words):
        layered(preset("default"), environment={}, assignments=[assignment])


@pytest.mark.parametrize(
    ("assignments", "words"),
    [
        (["width=8192", "height=8192"], "would take 13,421 MB .* at most 1,000 MB"),
        (["max_depth_m=100", "mapping.cell_size_m=0.01"], "range of 100 m .* 2,000 MB"),
    ],
)
def test_values_that_together_take_too_much_memory_are_refused(assignments, words):
    named = [
        text if "." in text.split("=")[0] else f"embodiment.camera.{text}" for text in assignments
    ]
    with pytest.raises(ConfigError, match=words):
        layered(preset("default"), environment={}, assignments=named)


def test_there_are_at_most_200_values():
    """Each needs a reason that a user could give; what nobody sets is a constant."""
    assert len(values_by_field(HyPerNavConfig())) <= 200
