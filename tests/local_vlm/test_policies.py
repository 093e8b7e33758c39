"""PIRLNav's and ZSON's networks with random weights, and the conversion of checkpoints."""

import importlib.util
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from chat_models import image
from hypernav.core.embodiment import Action, Embodiment, MotionConfig
from hypernav.core.errors import ConfigError, GoalError, ModelError
from hypernav.core.goal import Goal
from hypernav.lab.evaluation.checks.contracts import check_agent
from hypernav.search.models.policy_network import PIRLNAV, ZSON, PolicyArchitecture, PolicyNetwork
from hypernav.search.rivals.config import PolicyConfig
from hypernav.search.rivals.policy import PirlnavAgent, ZsonAgent

ROBOT = Embodiment(motion=MotionConfig(forward_m=0.25))
BOTH = [PIRLNAV, ZSON]
POSE = (0.5, -0.25, 0.7)


def weights_of(architecture: PolicyArchitecture, seed: int = 0) -> dict[str, Any]:
    """Random weights of the real architecture, small enough that nothing saturates."""
    import torch

    generator = torch.Generator().manual_seed(seed)
    found = {}
    for name, shape in architecture.shapes().items():
        fan = math.prod(shape[1:]) or 1
        found[name] = torch.randn(shape, generator=generator) / math.sqrt(fan)
    found["running_mean_and_var._var"] = found["running_mean_and_var._var"].abs() + 0.1
    return found


def zeros_of(architecture: PolicyArchitecture) -> dict[str, Any]:
    import torch

    return {name: torch.zeros(shape) for name, shape in architecture.shapes().items()}


def inputs_of(architecture: PolicyArchitecture) -> dict[str, Any]:
    if architecture is PIRLNAV:
        return {"goal": 3, "pose": POSE, "last_action": 2}
    vector = np.random.default_rng(0).normal(size=1024).astype(np.float32)
    return {"goal": vector / np.linalg.norm(vector), "last_action": 2}


@pytest.mark.parametrize("architecture", BOTH, ids=lambda one: one.name)
def test_a_step_has_the_published_shapes_and_remembers(architecture):
    network = PolicyNetwork(weights_of(architecture), architecture)
    state, inputs = network.first_state(), inputs_of(architecture)
    assert tuple(state.shape) == {"pirlnav": (2, 2048), "zson": (4, 512)}[architecture.name]
    assert not state.any()
    rgb = image(0, 480, 640)
    logits, after = network.step(rgb, state, **inputs)
    assert logits.shape == ({"pirlnav": 6, "zson": 4}[architecture.name],)
    assert np.isfinite(logits).all()
    assert after.shape == state.shape
    again, _ = network.step(rgb, after, **inputs)
    assert not np.allclose(logits, again)


def test_a_gru_step_equals_one_done_by_hand():
    import torch

    weights = zeros_of(PIRLNAV)
    hidden = PIRLNAV.hidden
    # Without weights the gates are one half, so a layer is half the hyperbolic tangent of its bias.
    weights["rnn.bias_ih_l0"][2 * hidden :] = 0.4
    weights["rnn.bias_ih_l1"][2 * hidden :] = -0.3
    weights["rnn.bias_hh_l1"][2 * hidden :] = 0.2
    weights["action.weight"][:, 0] = torch.arange(6.0)
    weights["action.bias"][5] = 1.0
    network = PolicyNetwork(weights, PIRLNAV)
    logits, state = network.step(
        image(0, 480, 640), network.first_state(), goal=0, pose=POSE, last_action=0
    )
    second = 0.5 * math.tanh(-0.3 + 0.5 * 0.2)
    np.testing.assert_allclose(state[0], 0.5 * math.tanh(0.4), rtol=1e-5)
    np.testing.assert_allclose(state[1], second, rtol=1e-5)
    by_hand = second * np.arange(6.0) + np.array([0, 0, 0, 0, 0, 1.0])
    np.testing.assert_allclose(logits, by_hand, rtol=1e-5, atol=1e-7)


def test_an_lstm_step_equals_one_done_by_hand():
    weights = zeros_of(ZSON)
    hidden = ZSON.hidden
    # Enter, forget, new, leave: the gates are one half, and only new values have a bias.
    weights["rnn.bias_ih_l0"][2 * hidden : 3 * hidden] = 0.6
    weights["rnn.bias_hh_l1"][2 * hidden : 3 * hidden] = -1.0
    weights["action.weight"][1, :2] = 2.0
    network = PolicyNetwork(weights, ZSON)
    goal = np.zeros(1024, np.float32)
    logits, state = network.step(
        image(0, 480, 640), network.first_state(), goal=goal, last_action=0
    )
    cells = [0.5 * math.tanh(0.6), 0.5 * math.tanh(-1.0)]
    outputs = [0.5 * math.tanh(cell) for cell in cells]
    for layer, value in enumerate(outputs + cells):
        np.testing.assert_allclose(state[layer], value, rtol=1e-5)
    np.testing.assert_allclose(logits, [0.0, 4.0 * outputs[1], 0.0, 0.0], rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("architecture", BOTH, ids=lambda one: one.name)
def test_memory_equals_torchs_own_layers(architecture):
    import torch

    weights = weights_of(architecture)
    layer = {"gru": torch.nn.GRU, "lstm": torch.nn.LSTM}[architecture.cell]
    own = layer(architecture.recurrent_input, architecture.hidden, num_layers=2)
    own.load_state_dict({name[4:]: w for name, w in weights.items() if name.startswith("rnn.")})
    network = PolicyNetwork(weights, architecture)
    generator = torch.Generator().manual_seed(1)
    x = torch.randn(architecture.recurrent_input, generator=generator)
    state = torch.randn(network.first_state().shape, generator=generator)
    with torch.no_grad():
        if architecture.cell == "gru":
            expected = own(x[None], state)[1]
        else:
            expected = torch.cat(own(x[None], (state[:2], state[2:]))[1])
    torch.testing.assert_close(network._remember(x, state), expected, rtol=1e-4, atol=1e-5)


def test_a_bottleneck_equals_torchs_own_layers():
    import torch
    from torch import nn

    weights, planes, after, before = weights_of(ZSON), 64, 256, 128
    name = "backbone.layer2.0"

    def loaded(*layers: tuple[str, nn.Module]) -> nn.Module:
        for part, layer in layers:
            start = f"{name}.{part}."
            layer.load_state_dict(
                {key.removeprefix(start): w for key, w in weights.items() if key.startswith(start)}
            )
        return nn.Sequential(*(layer for _, layer in layers))

    own = loaded(
        ("conv1", nn.Conv2d(before, planes, 1, bias=False)),
        ("bn1", nn.GroupNorm(16, planes)),
        ("", nn.ReLU()),
        ("conv2", nn.Conv2d(planes, planes, 3, stride=2, padding=1, bias=False)),
        ("bn2", nn.GroupNorm(16, planes)),
        ("", nn.ReLU()),
        ("conv3", nn.Conv2d(planes, after, 1, bias=False)),
        ("bn3", nn.GroupNorm(16, after)),
    )
    beside = loaded(
        ("downsample.0", nn.Conv2d(before, after, 1, stride=2, bias=False)),
        ("downsample.1", nn.GroupNorm(16, after)),
    )
    x = torch.randn(1, before, 8, 8, generator=torch.Generator().manual_seed(1))
    with torch.no_grad():
        expected = (own(x) + beside(x)).relu()
        found = PolicyNetwork(weights, ZSON)._bottleneck(name, x, 2)
    torch.testing.assert_close(found, expected, rtol=1e-4, atol=1e-5)


def test_an_image_is_shrunk_cut_and_normalised():
    weights = zeros_of(PIRLNAV)
    weights["running_mean_and_var._mean"][:] = 0.5
    weights["running_mean_and_var._var"][:] = 0.04
    network = PolicyNetwork(weights, PIRLNAV)
    rgb = np.zeros((480, 640, 3), np.uint8)
    rgb[:, 80:560] = 255  # what is left of a square in the middle
    prepared = network._prepared(rgb)
    assert tuple(prepared.shape) == (1, 3, 256, 256)
    np.testing.assert_allclose(prepared[..., 1:-1], (1.0 - 0.5) / 0.2, rtol=1e-5)


@pytest.mark.parametrize("architecture", BOTH, ids=lambda one: one.name)
def test_an_image_is_shrunk_between_its_nearest_pixels_to_whole_grades(architecture):
    weights = zeros_of(architecture)
    weights["running_mean_and_var._var"][:] = 1.0
    side = architecture.image_px
    rgb = np.zeros((4 * side, 4 * side, 3), np.uint8)
    # Of four pixels in a row the middle two are looked at, and 0.5 * (11 + 20) is 15.5.
    rgb[:, 0::4], rgb[:, 1::4], rgb[:, 2::4], rgb[:, 3::4] = 200, 11, 20, 90
    prepared = PolicyNetwork(weights, architecture)._prepared(rgb)
    np.testing.assert_allclose(prepared, np.full((1, 3, side, side), 16.0 / 255.0), rtol=1e-6)


def test_what_pirlnav_sees_ends_rectified_and_what_zson_sees_does_not():
    # Linear, ReLU in PIRLNav's published code; Linear, ReLU, Linear in ZSON's.
    for architecture, last, seen in ((PIRLNAV, "visual_fc.0", 0.0), (ZSON, "visual_fc.1", -2.0)):
        weights = zeros_of(architecture)
        weights[f"{last}.bias"][:] = -2.0
        network = PolicyNetwork(weights, architecture)
        np.testing.assert_array_equal(
            network._see(network._prepared(image(0, 480, 640))),
            np.full(architecture.visual[-1], seen, np.float32),
        )


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda weights: weights.pop("action.bias"), "action.bias is missing"),
        (lambda weights: weights.update(more=weights["action.bias"]), "more is unknown"),
        (
            lambda weights: weights.update({"action.bias": weights["action.bias"][:4]}),
            r"action.bias is \(4,\) instead of \(6,\)",
        ),
    ],
)
def test_other_networks_are_refused(change, reason):
    weights = zeros_of(PIRLNAV)
    change(weights)
    with pytest.raises(ModelError, match=reason):
        PolicyNetwork(weights, PIRLNAV)


@pytest.fixture
def files(tmp_path: Path) -> dict[str, Path]:
    from safetensors.numpy import save_file as save_arrays
    from safetensors.torch import save_file

    paths = {name: tmp_path / f"{name}.safetensors" for name in ("pirlnav", "zson", "goals")}
    save_file(weights_of(PIRLNAV), paths["pirlnav"])
    save_file(weights_of(ZSON), paths["zson"])
    rng = np.random.default_rng(0)
    vectors = {name: rng.normal(size=1024).astype(np.float32) for name in ("bed", "plant")}
    save_arrays(vectors, paths["goals"])
    return paths


def test_agents_from_files_keep_the_contract(files: dict[str, Path]):
    check_agent(PirlnavAgent(str(files["pirlnav"]), ROBOT), goal="bed", steps=4)
    config = PolicyConfig(goals=str(files["goals"]))
    check_agent(ZsonAgent(str(files["zson"]), ROBOT, config), goal="bed", steps=4)


def test_zson_needs_the_vector_of_its_goal(files: dict[str, Path]):
    with pytest.raises(ConfigError, match=r"policy\.goals"):
        ZsonAgent(str(files["zson"]), ROBOT)
    agent = ZsonAgent(str(files["zson"]), ROBOT, PolicyConfig(goals=str(files["goals"])))
    assert np.linalg.norm(agent.goal_input(Goal("potted plant"))) == pytest.approx(1.0)
    with pytest.raises(GoalError, match="no vector for 'sofa'"):
        agent.check_goal(Goal("sofa"))


def test_what_is_no_safetensors_file_is_refused(tmp_path: Path):
    path = tmp_path / "pickled.ckpt"
    path.write_bytes(pickle.dumps({"state_dict": {}}))
    with pytest.raises(ModelError, match=r"convert_policy\.py"):
        PirlnavAgent(str(path), ROBOT)
    with pytest.raises(ModelError, match="can't be read"):
        PirlnavAgent(str(tmp_path / "absent.safetensors"), ROBOT)


def converter() -> Any:
    path = Path(__file__).parents[2] / "scripts" / "convert_policy.py"
    spec = importlib.util.spec_from_file_location("convert_policy", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Trap:
    """Leaves a trace if it is ever unpickled."""

    def __init__(self, path: Path):
        self.path = path

    def __reduce__(self):
        return (Path.touch, (self.path,))


PUBLISHED = {
    PIRLNAV: {
        "running_mean_and_var": "net.visual_encoder.running_mean_and_var",
        "visual_fc.0": "net.visual_fc.1",
        "goal_embedding": "net.obj_categories_embedding",
        "gps_embedding": "net.gps_embedding",
        "compass_embedding": "net.compass_embedding",
    },
    ZSON: {
        "running_mean_and_var": "net.visual_encoder.normalize",
        "visual_fc.0": "net.policy_mlp.0",
        "visual_fc.1": "net.policy_mlp.2",
    },
}
"""Names that layers have in the published code: Ram81/pirlnav, gunagg/zson."""
PUBLISHED_OF_BOTH = {
    "backbone": "net.visual_encoder.backbone",
    "compression": "net.visual_encoder.compression",
    "prev_action_embedding": "net.prev_action_embedding",
    "rnn": "net.state_encoder.rnn",
    "action": "action_distribution.linear",
}


def published(name: str, architecture: PolicyArchitecture) -> str:
    """The name that a weight has in a checkpoint."""
    layers = PUBLISHED[architecture] | PUBLISHED_OF_BOTH
    ours = next(layer for layer in layers if name.startswith(f"{layer}."))
    return f"actor_critic.{layers[ours]}{name.removeprefix(ours)}"


@pytest.mark.parametrize("architecture", BOTH, ids=lambda one: one.name)
def test_weights_are_found_by_their_published_names(architecture):
    names = {published(name, architecture): name for name in architecture.shapes()}
    count = published("running_mean_and_var._count", architecture)
    found = converter().converted_names(
        architecture.name, [*names, count, "actor_critic.critic.fc.bias"]
    )
    assert found == names


def test_a_checkpoint_is_converted_and_nothing_in_it_is_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    import torch
    from safetensors.torch import load_file

    module, trap = converter(), tmp_path / "trapped"
    weights = weights_of(ZSON)
    states = {published(name, ZSON): tensor for name, tensor in weights.items()}
    states["actor_critic.critic.fc.bias"] = torch.zeros(1)
    source, target = tmp_path / "zson.ckpt", tmp_path / "zson.safetensors"
    torch.save({"state_dict": states, "config": Trap(trap)}, source)
    arguments = ["convert_policy.py", "zson", str(source), str(target)]
    monkeypatch.setattr("sys.argv", arguments)
    module.main()
    assert not trap.exists()
    loaded = load_file(target)
    assert loaded.keys() == weights.keys()
    assert all(torch.equal(loaded[name], weights[name]) for name in weights)
    PolicyNetwork.load(target, ZSON)


def test_unknown_names_are_said_and_can_be_renamed():
    module = converter()
    with pytest.raises(SystemExit, match=r"net\.mystery\.weight"):
        module.converted_names("zson", ["actor_critic.net.mystery.weight"])
    renamed = module.converted_names("zson", ["net.mystery.weight"], [("net.mystery.", "action.")])
    assert renamed == {"net.mystery.weight": "action.weight"}
    assert module.converted_names("zson", ["net.mystery.weight"], [("net.mystery.", "")]) == {}


def test_actions_have_the_numbers_of_the_policies():
    assert [action.name for action in sorted(Action)] == [
        "STOP",
        "MOVE_FORWARD",
        "TURN_LEFT",
        "TURN_RIGHT",
    ]
