"""The policies have the weights of the published networks."""

import math

import pytest

from hypernav.search.models.policy_network import PIRLNAV, ZSON, PolicyArchitecture


@pytest.mark.parametrize(
    ("architecture", "weights", "values"), [(PIRLNAV, 182, 48_955_084), (ZSON, 179, 14_096_074)]
)
def test_networks_have_the_published_size(
    architecture: PolicyArchitecture, weights: int, values: int
):
    shapes = architecture.shapes()
    assert (len(shapes), sum(math.prod(shape) for shape in shapes.values())) == (weights, values)
    assert (
        architecture.state_layers * architecture.hidden
        == {"gru": 4096, "lstm": 2048}[architecture.cell]
    )


def test_each_layer_takes_what_the_one_before_gives():
    for architecture in (PIRLNAV, ZSON):
        shapes = architecture.shapes()
        side = architecture.image_px // 32
        flat = architecture.channels * side * side
        assert shapes["visual_fc.0.weight"][1] == flat
        last = shapes[f"visual_fc.{len(architecture.visual) - 1}.weight"][0]
        embedded = [
            shape[0] if "bias" in name else shape[1]
            for name, shape in shapes.items()
            if name
            in (
                "prev_action_embedding.weight",
                "goal_embedding.weight",
                "gps_embedding.bias",
                "compass_embedding.bias",
            )
        ]
        inputs = last + architecture.goal_size + sum(embedded)
        assert shapes["rnn.weight_ih_l0"][1] == inputs == architecture.recurrent_input


def test_the_stages_of_the_backbone_have_their_published_names():
    names = {name.split(".")[1] for name in PIRLNAV.shapes() if name.startswith("backbone.layer")}
    assert names == {f"layer{number}" for number in (1, 2, 3, 4)}
