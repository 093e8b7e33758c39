"""The study of switches: parts of the paper's method, and every rule of ``default``.

A switch is a field of the configuration; those that cannot matter with the components in use are
left out, with the reason.
The descriptions are read from the docstrings, so that nothing is explained twice.
"""

import json
from collections.abc import Iterator
from functools import cache
from typing import Any

from pydantic import BaseModel

from hypernav.app.build.components.construction import asked_by
from hypernav.app.build.components.registries import COMPONENTS
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.components.abilities import answers_at_once
from hypernav.core.config import UNITS, meanings
from hypernav.core.errors import ConfigError
from hypernav.lab.evaluation.ablation.study import LeftOut, Method, Study, Variant

_UNITS = {ending: unit for ending, unit in UNITS.items() if ending != "_steps"}
"""Units that take the place of the ending in the name of a switch."""


def values_by_field(config: BaseModel, prefix: str = "") -> dict[str, Any]:
    """All values of a configuration by the full names of their fields."""
    values: dict[str, Any] = {}
    for key in type(config).model_fields:
        value, name = getattr(config, key), f"{prefix}{key}"
        if isinstance(value, BaseModel):
            values |= values_by_field(value, f"{name}.")
        else:
            values[name] = value
    return values


def differing_fields(a: HyPerNavConfig, b: HyPerNavConfig) -> list[str]:
    """Full names of the fields in which two configurations differ."""
    before, after = values_by_field(a), values_by_field(b)
    return [name for name, value in before.items() if value != after[name]]


def assignment(field: str, value: Any) -> str:
    """The assignment that gives a field its value, as ``--set`` takes it."""
    return f"{field}={json.dumps(value)}"


def switch_name(field: str, value: Any) -> str:
    """Short name of a field with a value, for people: "bump sensor: off", "margin: 0.12 m"."""
    section, _, key = field.rpartition(".")
    ending = next((end for end in _UNITS if key.endswith(end)), "")
    words = key.removesuffix(ending)
    if _names_of_fields().count(key) > 1:
        words = f"{section.rpartition('.')[2]} {words}"
    unit = f" {_UNITS[ending]}" if ending and value is not None else ""
    return f"{words.replace('_', ' ')}: {_shown(value)}{unit}"


@cache
def words_of(field: str) -> str:
    """The sentence of the docstring that says what a field is."""
    *sections, key = field.split(".")
    model: type[BaseModel] = HyPerNavConfig
    for section in sections:
        model = _section(model, section)
    return meanings(model)[key]


@cache
def _names_of_fields() -> list[str]:
    return [name.rpartition(".")[2] for name in values_by_field(HyPerNavConfig())]


def _section(model: type[BaseModel], name: str) -> type[BaseModel]:
    section = model.model_fields[name].annotation
    assert isinstance(section, type)
    assert issubclass(section, BaseModel)
    return section


def _shown(value: Any) -> str:
    match value:
        case None:
            return "none"
        case bool():
            return "on" if value else "off"
        case float():
            return f"{value:g}"
    return str(value)


_DRAWN = frozenset(
    f"overview.{key}"
    for key in (
        "image_px",
        "strong_colors",
        "draw_frontier",
        "fill_obstacles",
        "clear_numbers",
        "label_things",
    )
)
_ASKED = frozenset(f"block_choice.{key}" for key in ("mode", "facts", "list_excluded"))
_ABOUT_EROSION = frozenset({"local.erosion_px", "local.keep_thin_masks"})


def why_idle(variant: Variant, method: Method) -> str:
    """The reason why a variant of a method cannot differ from it; empty if it can."""
    varied = method.varied(variant)
    fields = differing_fields(method.config, varied.config)
    try:
        same_components = varied.chosen.as_dict() == method.chosen.as_dict()
    except ConfigError as error:
        return str(error)
    reasons = [why_unread(field, method) for field in fields]
    if not all(reasons):
        return ""
    if varied.specs != method.specs and not same_components:
        return ""
    return reasons[0] if reasons else "it is so already"


def why_unread(field: str, method: Method) -> str:
    """The reason why nothing in use reads a field; empty if something does."""
    chosen, local = method.chosen, method.config.local
    section = field.partition(".")[0]
    asks_model = chosen.reasoner is not None and "chat" in asked_by(chosen.reasoner)
    if field in ("local.published_segmenter", "chat.published_model"):
        return "it changes only how screens and reports name what is in use"
    if section in _sections_of_components() - _sections_in_use(method):
        return f"no component in use reads the section '{section}'"
    if field in _DRAWN | _ASKED and not asks_model:
        return "no model is asked about the map"
    if field == "mapping.block_destination" and not chosen.chooses_blocks:
        return f"--agent {chosen.agent.spec} goes to no blocks"
    if field == "search.reconsider_steps":
        chooses = chosen.reasoner or chosen.agent
        return "" if answers_at_once(chooses.load()) else f"{chooses.spec} is asked only once"
    if (section == "presence" or field == "search.verify_view") and not chosen.presence:
        return "without a model nobody checks the presence of the goal"
    if field in _ABOUT_EROSION and local.pixels == "box":
        return "a box is not eroded"
    if field == "local.keep_thin_masks" and local.erosion_px == 1:
        return "no mask is eroded"
    return ""


def _sections_of_components() -> set[str]:
    return set().union(*(registry.sections for registry in COMPONENTS))


def _sections_in_use(method: Method) -> set[str]:
    choices = method.chosen.by_kind.values()
    used = {choice.entry.section for choice in choices}
    if any("fallback" in asked_by(choice) for choice in choices):
        used.add("geometric")
    return used


ABLATIONS = (
    Variant(
        "local only",
        "The map is not read: while the goal is out of sight the robot goes to a random block. "
        "The block is one of those that a model would be offered: in the preset default a block at "
        "random among those with something new (at most 20), in paper any.",
        components=(("reasoner", "random"),),
    ),
    Variant(
        "global only",
        "Images are searched for the goal only while the robot turns once around, which it does "
        "before every question about the map.",
        ("search.looks=at-destinations",),
    ),
    Variant(
        "raw box instead of mask",
        "All pixels of a detection's box count, and nothing is eroded.",
        ("local.pixels=box",),
    ),
    Variant("no erosion", "The mask is not eroded.", ("local.erosion_px=1",)),
    Variant(
        "no dilation",
        "The goal area is the cells that the goal was seen in.",
        ("local.dilation_iterations=0",),
    ),
    Variant(
        "no visited memory",
        "Blocks may be named repeatedly; none is excluded.",
        ("overview.visited=none",),
    ),
    Variant(
        "no presence check",
        "At the goal area the robot stops without asking whether the goal is really there.",
        ("presence.enabled=false",),
    ),
    Variant(
        "no replanning",
        "A path is kept to its end unless it is blocked; blocked paths are planned anew all the "
        "same.",
        ("planning.replan_every_steps=null", "planning.replan_when_moved=false"),
    ),
)
"""Ablations of the parts that the paper describes; they are ours, it prints none in simulation."""


def switches(method: Method) -> Study:
    """Ablations of the paper's parts; for ``default`` also every switch, turned back one at a time.

    Raises:
        ConfigError: The agent is not an explorer, so it has none of these switches.
    """
    if method.chosen.is_whole_agent:
        raise ConfigError(
            f"--agent {method.chosen.agent.spec} acts by itself and has none of the switches of "
            "this study; use hypernav or another explorer"
        )
    variants = [
        Variant("unchanged", f"The preset {method.preset} with the options of the command.")
    ]
    left_out = []
    for variant in (*ABLATIONS, *(_turned_back() if method.preset == "default" else ())):
        if why := why_idle(variant, method):
            left_out.append(LeftOut(variant, why))
        else:
            variants.append(variant)
    return Study(
        f"What each part of the “{method.preset}” preset is worth", tuple(variants), tuple(left_out)
    )


def _turned_back() -> Iterator[Variant]:
    """Every field in which ``default`` differs from ``paper``, with the paper's value."""
    values = values_by_field(preset("paper"))
    for field in differing_fields(preset("default"), preset("paper")):
        value = values[field]
        yield Variant(switch_name(field, value), words_of(field), (assignment(field, value),))
