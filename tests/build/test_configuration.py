import math
from typing import Any

import pytest
import yaml
from annotated_types import Ge, Gt
from pydantic import BaseModel, ValidationError

from hypernav.build.presets import HyPerNavConfig, preset
from hypernav.core.config import RENAMED, layered
from hypernav.core.errors import ConfigError


def numbers(model: type[BaseModel] = HyPerNavConfig, section: str = ""):
    """Name and definition of every number in a configuration."""
    for name, field in model.model_fields.items():
        kind = field.annotation
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            yield from numbers(kind, f"{section}{name}.")
        elif kind in (int, float, int | None, float | None):
            yield f"{section}{name}", field


def with_value(name, value):
    values = preset("default").model_dump()
    *sections, key = name.split(".")
    section_values = values
    for section in sections:
        section_values = section_values[section]
    section_values[key] = value
    return HyPerNavConfig.model_validate(values)


def lower_bound(field) -> float | None:
    bounds: list[Any] = [
        m.ge if isinstance(m, Ge) else m.gt for m in field.metadata if isinstance(m, Ge | Gt)
    ]
    return bounds[0] if bounds else None


NUMBERS = dict(numbers())


def test_the_walk_finds_the_numbers():
    assert {"embodiment.body.radius_m", "search.patience_steps", "chat.seed"} <= set(NUMBERS)
    assert len(NUMBERS) > 80


@pytest.mark.parametrize("name", NUMBERS)
def test_every_number_has_a_bound_and_is_a_number(name):
    bound = lower_bound(NUMBERS[name])
    assert bound is not None, "give it a lower bound"
    for nonsense in (math.nan, math.inf, -math.inf, bound - 1):
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
    ],
)
def test_nonsense_is_refused_with_the_reason(assignment, words):
    with pytest.raises(ConfigError, match=words):
        layered(preset("default"), environment={}, assignments=[assignment])


@pytest.mark.parametrize("name", RENAMED)
def test_an_old_name_gives_the_new_one_wherever_it_is_written(name, tmp_path):
    new = RENAMED[name].split(" ")[0].rstrip(",")
    *sections, key = name.split(".")
    content = {key: 1}
    for section in reversed(sections):
        content = {section: content}
    file = tmp_path / "old.yaml"
    file.write_text(yaml.safe_dump(content))
    variable = "HYPERNAV_" + name.upper().replace(".", "__")
    for layer in (
        lambda: layered(preset("default"), assignments=[f"{name}=1"], environment={}),
        lambda: layered(preset("default"), file=file, environment={}),
        lambda: layered(preset("default"), environment={variable: "1"}),
    ):
        with pytest.raises(ConfigError, match=f"'{name}' is now {new}"):
            layer()


@pytest.mark.parametrize("name", RENAMED)
def test_every_new_name_exists(name):
    values = preset("default").model_dump()
    for key in RENAMED[name].split(" ")[0].rstrip(",").split("."):
        values = values[key]
