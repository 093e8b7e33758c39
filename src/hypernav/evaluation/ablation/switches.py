"""The study of switches: parts of the paper's method, and every rule of ``default``."""

from collections.abc import Iterator

from hypernav.build.presets import preset
from hypernav.core.errors import ConfigError
from hypernav.evaluation.ablation.config_fields import (
    assignment,
    differing_fields,
    switch_name,
    values_by_field,
    words_of,
)
from hypernav.evaluation.ablation.relevance import why_idle
from hypernav.evaluation.ablation.study import LeftOut, Method, Study, Variant

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
