"""The study of models: its variants, and its figure from runs made by hand."""

import pytest

from eval_runs import record
from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.app.build.presets import preset
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered
from hypernav.lab.evaluation.ablation.ablation_page import write_ablation
from hypernav.lab.evaluation.ablation.model_quality import LEVELS, RATES, model_quality
from hypernav.lab.evaluation.ablation.study import Method
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.store.run_store import RunStore

MODEL = ComponentSpecs(vlm="replay:none.jsonl")
WHO = {"agent": "hypernav", "preset": "paper", "detector": "ground truth", "reasoner": "geometric"}


def study(of: PresetName = "default", specs: ComponentSpecs | None = None):
    return model_quality(Method(of, preset(of), specs or ComponentSpecs()))


@pytest.mark.parametrize("specs", [ComponentSpecs(), MODEL], ids=["no model", "model"])
@pytest.mark.parametrize("of", ["default", "paper"])
def test_every_variant_can_be_built_and_has_a_folder_of_its_own(of, specs):
    method = Method(of, preset(of), specs)
    one = model_quality(method)
    assert one.left_out == ()
    for variant in one.variants:
        chosen = method.varied(variant).chosen.as_dict()
        assert all(chosen[kind] == spec for kind, spec in variant.components)
    assert len({variant.slug for variant in one.variants}) == len(one.variants)


def test_every_rate_and_level_is_a_point_of_a_curve_on_an_axis():
    one = study()
    first, second = one.axes
    points = {
        curve: [v.quality for v in one.variants if v.curve == curve]
        for curve in (*first.curves, *second.curves)
    }
    rates, *levels = points.values()
    assert rates == list(RATES)
    assert levels == [[0.0, 1.0, 2.0, 3.0]] * 2
    assert second.ticks == LEVELS == ("poor", "fair", "good", "perfect")
    on_curves = sum(map(len, points.values()))
    assert len(one.variants) == on_curves + len(first.lines)


def test_the_unchanged_method_is_named_by_what_it_is():
    assert study().variants[0].name == "geometric rule"
    assert study(specs=MODEL).variants[0].name == "reasoner vlm"


def test_what_cannot_be_run_is_left_out_with_the_reason():
    config = layered(preset("paper"), environment={}, assignments=["presence.enabled=false"])
    specs = ComponentSpecs(vlm="replay:none.jsonl", detector="ground-truth")
    left_out = model_quality(Method("paper", config, specs)).left_out
    assert left_out[0].variant.name == "random block"
    assert "would never be asked" in left_out[0].why


def test_the_nearest_frontier_needs_no_reasoner_that_was_named():
    one = study(specs=ComponentSpecs(reasoner="geometric"))
    assert one.left_out == ()
    (frontier,) = [variant for variant in one.variants if variant.name == "nearest frontier"]
    assert frontier.changes == "--agent frontier (no --reasoner)"


@pytest.mark.parametrize(
    ("specs", "name", "quality"),
    [
        (ComponentSpecs(reasoner="noisy:1"), "P = 1", 1.0),
        (ComponentSpecs(reasoner="random"), "random block", None),
        (ComponentSpecs(detector="noisy:poor"), "poor detector", 0.0),
    ],
)
def test_nothing_is_run_twice(specs, name, quality):
    method = Method("default", preset("default"), specs)
    one = model_quality(method)
    why = {left.variant.name: left.why for left in one.left_out}
    assert why[name] == "it is so already"
    made = [tuple(method.varied(v).chosen.as_dict().items()) for v in one.variants]
    assert len(set(made)) == len(made)
    assert one.variants[0].quality == quality  # it takes the place on the curve


def test_an_agent_without_a_reasoner_has_no_such_study():
    with pytest.raises(ConfigError, match="use hypernav"):
        study(specs=ComponentSpecs(agent="frontier"))


def test_the_figure_names_every_curve_and_line_and_draws_what_there_is(tmp_path):
    one = study()
    scenes = [f"house {number}" for number in range(4)]
    for place, variant in enumerate(one.variants[:-1]):  # the last one is still to be run
        configuration = RunPlan("houses-val", who=WHO).configuration([])
        configuration["episodes"] |= {"count": len(scenes), "scenes": len(scenes)}
        with RunStore(tmp_path / variant.slug, configuration) as store:
            for scene in scenes:
                store.add(record("0", scene, shortest_path_m=4.0, path_length_m=5.0 + place))
    write_ablation(tmp_path, one)
    drawn = (tmp_path / "figure.svg").read_text()
    for axis in one.axes:
        for name in (*axis.curves, *axis.lines, *axis.ticks, axis.words):
            assert f"<!-- {name} -->" in drawn
