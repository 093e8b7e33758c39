"""Architectures of PIRLNav's and ZSON's policies: names and shapes of all their weights.

Both encode images with a ResNet-50 of half the usual width, with group instead of batch
normalisation (Wijmans et al., "DD-PPO", 2020), and have two recurrent layers. Sources:
Ramrakhya et al., "PIRLNav", 2023 (Ram81/pirlnav: ``pirlnav/policy``); Majumdar et al., "ZSON", 2022
(gunagg/zson: ``zson/policy.py``, ``zson/visual_encoder.py``, ``configs/experiments``). Names of the
ResNet's weights are theirs; those of the rest are ours, see ``scripts/convert_policy.py``.
"""

from dataclasses import dataclass
from typing import Literal

BLOCKS = (3, 4, 6, 3)
"""Number of bottlenecks in each layer of the ResNet."""
PLANES = 32
"""Width of its first layer; each of the next is twice as wide."""
EXPANSION = 4
GROUPS = PLANES // 2
"""Groups of each normalisation in the ResNet of both."""
_FLAT = 2048
"""Number of values that an image is compressed to."""
EMBEDDED = 32
"""Number of values that each of the other inputs is embedded in."""

Shapes = dict[str, tuple[int, ...]]


@dataclass(frozen=True)
class PolicyArchitecture:
    """Dimensions of a policy.

    Attributes:
        name: Name of the policy.
        image_px: Side of the square image that it looks at, pixels.
        visual: Widths of the layers after the ResNet, with a rectifier between them.
        rectifies_last: Whether the last of these ends with a rectifier as well.
        cell: Kind of the two recurrent layers.
        hidden: Width of the recurrent layers.
        goals: Number of goals, if a goal is an index; 0 if a goal is a vector.
        goal_size: Length of a goal's vector; 0 if a goal is an index.
        has_pose: Whether position and heading since the start are inputs.
        actions: Number of actions.
    """

    name: str
    image_px: int
    visual: tuple[int, ...]
    rectifies_last: bool
    cell: Literal["gru", "lstm"]
    hidden: int
    goals: int
    goal_size: int
    has_pose: bool
    actions: int

    @property
    def channels(self) -> int:
        """Channels of the compressed image, which has one position for every 32 pixels."""
        return round(_FLAT / (self.image_px // 32) ** 2)

    @property
    def recurrent_input(self) -> int:
        """Number of inputs of the first recurrent layer."""
        embedded = 1 + (self.goals > 0) + 2 * self.has_pose
        return self.visual[-1] + self.goal_size + EMBEDDED * embedded

    @property
    def state_layers(self) -> int:
        """Layers of the state: outputs of both recurrent layers, then the cells of an LSTM."""
        return 2 if self.cell == "gru" else 4

    def shapes(self) -> Shapes:
        """Names and shapes of all weights."""
        found = _encoder_shapes(self.channels)
        inputs = _FLAT
        for k, outputs in enumerate(self.visual):
            found |= _linear(f"visual_fc.{k}", inputs, outputs)
            inputs = outputs
        found["prev_action_embedding.weight"] = (self.actions + 1, EMBEDDED)
        if self.goals:
            found["goal_embedding.weight"] = (self.goals, EMBEDDED)
        if self.has_pose:
            found |= _linear("gps_embedding", 2, EMBEDDED)
            found |= _linear("compass_embedding", 2, EMBEDDED)
        gates = (3 if self.cell == "gru" else 4) * self.hidden
        for layer, inputs in enumerate((self.recurrent_input, self.hidden)):
            found |= {
                f"rnn.weight_ih_l{layer}": (gates, inputs),
                f"rnn.weight_hh_l{layer}": (gates, self.hidden),
                f"rnn.bias_ih_l{layer}": (gates,),
                f"rnn.bias_hh_l{layer}": (gates,),
            }
        return found | _linear("action", self.hidden, self.actions)


PIRLNAV = PolicyArchitecture(
    name="pirlnav",
    image_px=256,
    visual=(512,),
    rectifies_last=True,
    cell="gru",
    hidden=2048,
    goals=6,
    goal_size=0,
    has_pose=True,
    actions=6,
)
ZSON = PolicyArchitecture(
    name="zson",
    image_px=128,
    visual=(256, 512),
    rectifies_last=False,
    cell="lstm",
    hidden=512,
    goals=0,
    goal_size=1024,
    has_pose=False,
    actions=4,
)


def _linear(name: str, inputs: int, outputs: int) -> Shapes:
    return {f"{name}.weight": (outputs, inputs), f"{name}.bias": (outputs,)}


def _norm(name: str, channels: int) -> Shapes:
    return {f"{name}.weight": (channels,), f"{name}.bias": (channels,)}


def _encoder_shapes(channels: int) -> Shapes:
    """Input normalisation, ResNet and compression."""
    found: Shapes = {
        "running_mean_and_var._mean": (1, 3, 1, 1),
        "running_mean_and_var._var": (1, 3, 1, 1),
        "backbone.conv1.weight": (PLANES, 3, 7, 7),
        **_norm("backbone.bn1", PLANES),
    }
    before = PLANES
    for layer, blocks in enumerate(BLOCKS):
        planes = PLANES * 2**layer
        after = planes * EXPANSION
        for block in range(blocks):
            name = f"backbone.layer{layer + 1}.{block}"
            found[f"{name}.conv1.weight"] = (planes, before, 1, 1)
            found |= _norm(f"{name}.bn1", planes)
            found[f"{name}.conv2.weight"] = (planes, planes, 3, 3)
            found |= _norm(f"{name}.bn2", planes)
            found[f"{name}.conv3.weight"] = (after, planes, 1, 1)
            found |= _norm(f"{name}.bn3", after)
            if block == 0:
                found[f"{name}.downsample.0.weight"] = (after, before, 1, 1)
                found |= _norm(f"{name}.downsample.1", after)
            before = after
    found["compression.0.weight"] = (channels, before, 3, 3)
    return found | _norm("compression.1", channels)
