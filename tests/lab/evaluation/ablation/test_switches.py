"""The variants of the study of switches, against the presets and the components in use."""

import math
from functools import reduce
from pathlib import Path

import pytest

from certainty import certain
from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import Action
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import without_timings
from hypernav.io.layered_config import layered
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.evaluation.ablation.study import Method, Study, Variant
from hypernav.lab.evaluation.ablation.switches import (
    ABLATIONS,
    differing_fields,
    switches,
    values_by_field,
    words_of,
)
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

PAGE = (Path(__file__).parents[4] / "docs" / "evaluation.md").read_text(encoding="utf-8")
MODEL = ComponentSpecs(vlm="replay:none.jsonl")


def method(of: PresetName, specs: ComponentSpecs | None = None, *assignments: str) -> Method:
    config = layered(preset(of), environment={}, assignments=assignments)
    return Method(of, config, specs or ComponentSpecs())


def changed(variant: Variant, of: Method) -> list[str]:
    """The fields that a variant changes."""
    return differing_fields(of.config, of.varied(variant).config)


def fields_of(variants) -> set[str]:
    return {assignment.partition("=")[0] for one in variants for assignment in one.assignments}


def names(study: Study) -> set[str]:
    return {variant.slug for variant in study.variants}


CASES = [
    pytest.param(of, specs, id=f"{of}-{specs.agent}-{specs.vlm}")
    for of in ("paper", "default")
    for specs in (ComponentSpecs(), MODEL, ComponentSpecs(agent="frontier"))
]


@pytest.mark.parametrize("specs", [ComponentSpecs(), MODEL], ids=["no model", "model"])
def test_every_difference_of_the_presets_is_turned_back_or_left_out_with_a_reason(specs):
    study = switches(method("default", specs))
    different = set(differing_fields(preset("default"), preset("paper")))
    own = [one for one in study.variants if one not in ABLATIONS]
    out = [one.variant for one in study.left_out if one.variant not in ABLATIONS]
    assert fields_of(own) | fields_of(out) == different
    assert not fields_of(own) & fields_of(out)
    assert all(one.why for one in study.left_out)
    paper = values_by_field(preset("paper"))
    for variant in own[1:]:
        config = layered(preset("default"), environment={}, assignments=variant.assignments)
        (field,) = differing_fields(preset("default"), config)
        assert values_by_field(config)[field] == paper[field]


@pytest.mark.parametrize(("of", "specs"), CASES)
def test_every_variant_changes_exactly_what_it_names(of, specs):
    base = method(of, specs)
    first, *others = switches(base).variants
    assert changed(first, base) == []
    for variant in others:
        assert set(changed(variant, base)) <= fields_of([variant])
        assert changed(variant, base) or base.varied(variant).chosen != base.chosen
        assert variant.words.endswith((".", ")"))


@pytest.mark.parametrize(("of", "specs"), CASES)
def test_names_and_folders_are_unique(of, specs):
    study = switches(method(of, specs))
    assert len(names(study)) == len(study.variants)


def test_what_only_a_model_is_asked_is_left_out_without_one():
    alone, asked = switches(method("default")), switches(method("default", MODEL))
    assert {"no-presence-check", "facts-off", "strong-colors-off", "score-crops-0"} <= names(asked)
    assert not {"no-presence-check", "facts-off", "strong-colors-off"} & names(alone)
    why = {one.variant.slug: one.why for one in alone.left_out}
    assert why["no-presence-check"] == "without a model nobody checks the presence of the goal"


def test_an_explorer_without_blocks_has_no_memory_to_lose():
    study = switches(method("paper", ComponentSpecs(agent="frontier")))
    assert "no-visited-memory" not in names(study)
    assert "local-only" not in names(study)
    assert "no-erosion" in names(study)


def test_what_leaves_the_model_nothing_to_do_is_left_out():
    specs = ComponentSpecs(vlm="replay:none.jsonl", detector="ground-truth")
    study = switches(method("paper", specs, "presence.enabled=false"))
    why = {one.variant.slug: one.why for one in study.left_out}
    assert "would never be asked" in why["local-only"]
    assert "local-only" in names(switches(method("paper", specs)))


def test_what_is_so_already_is_left_out():
    study = switches(method("default", None, "planning.bump_sensor=false", "local.pixels=box"))
    why = {one.variant.slug: one.why for one in study.left_out}
    assert why["bump-sensor-off"] == why["raw-box-instead-of-mask"] == "it is so already"
    assert why["no-erosion"] == "a box is not eroded"


class Spinning:
    """An agent that acts itself."""

    def reset(self, goal):
        pass

    def act(self, observation):
        return Action.TURN_LEFT


def test_a_whole_agent_has_no_switches():
    whole = method("default", ComponentSpecs(agent=f"{__name__}:Spinning"))
    with pytest.raises(ConfigError, match="acts by itself"):
        switches(whole)


def test_the_docs_have_a_row_for_every_ablation_of_the_paper():
    lines = PAGE.splitlines()
    for one in ABLATIONS:
        (row,) = [line for line in lines if line.startswith(f"| `{one.slug}` |")]
        assert row.endswith(f"| `{one.changes}` |")


def test_the_words_of_every_field_are_its_own_sentence_of_the_docs():
    config = preset("default")
    words = {field: words_of(field) for field in values_by_field(config)}
    for field, said in words.items():
        *sections, key = field.split(".")
        documented = " ".join((type(reduce(getattr, sections, config)).__doc__ or "").split())
        assert f" {key}: {said}" in documented, field
        assert said.endswith("."), field
        assert len(said.split()) >= 3, field
    assert words["presence.enabled"] != words["local.erosion_px"]
    own = [(field.rpartition(".")[0], said) for field, said in words.items()]
    assert len(set(own)) == len(own)


def traced(method: Method) -> list[dict]:
    """A search by the agent of a method, step by step."""
    agent = build_agent(method.config, method.specs).agent
    start = Pose2(2.5, 1.0, math.pi / 2)
    run = EpisodeRun(agent, two_rooms(), episode_from(start, "bed", max_steps=80))
    steps = [certain(step.trace).model_dump(mode="json") for step in run]
    assert len(steps) > 20
    return [without_timings(step) for step in steps]


@pytest.mark.parametrize("agent", [pytest.param("hypernav", marks=pytest.mark.slow), "frontier"])
def test_what_is_left_out_really_makes_no_difference(agent):
    base = Method("default", small_config(), ComponentSpecs(agent=agent))
    idle = [one.variant for one in switches(base).left_out if not one.variant.components]
    together = Variant("all", "", tuple(a for one in idle for a in one.assignments))
    assert len(differing_fields(base.config, base.varied(together).config)) > 15
    assert traced(base.varied(together)) == traced(base)
