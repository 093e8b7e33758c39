"""PIRLNav's and ZSON's policies: names and shapes of all their weights, and one forward step.

Both encode images with a ResNet-50 of half the usual width, with group instead of batch
normalisation (Wijmans et al., "DD-PPO", 2020), and have two recurrent layers. Sources:
Ramrakhya et al., "PIRLNav", 2023 (Ram81/pirlnav: ``pirlnav/policy``); Majumdar et al., "ZSON", 2022
(gunagg/zson: ``zson/policy.py``, ``zson/visual_encoder.py``, ``configs/experiments``). Names of the
ResNet's weights are theirs; those of the rest are ours, see ``scripts/convert_policy.py``.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.components.registry import require
from hypernav.core.errors import ConfigError, ModelError

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

EXTRA = "policies"
_LEAST_VARIANCE = 1e-2
_NAMED = 5
"""Largest number of weights that a message names."""


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


class PolicyNetwork:
    """A policy's weights, and the forward step for an image, a goal, a pose and the last action.

    The batch size is one. The weights are never trained, so nothing here is a torch module.
    """

    def __init__(self, weights: Mapping[str, Any], architecture: PolicyArchitecture) -> None:
        """Check the weights.

        Args:
            weights: Tensors by name, float32.
            architecture: Dimensions of the policy.

        Raises:
            MissingExtraError: torch is not installed.
            ModelError: Weights are missing, unknown or of another shape; the message names some.
        """
        self._torch = require("torch", extra=EXTRA)
        _check_shapes(weights, architecture)
        self._weights = weights
        self._architecture = architecture

    @property
    def architecture(self) -> PolicyArchitecture:
        """Dimensions of the policy."""
        return self._architecture

    @staticmethod
    def load(path: Path, architecture: PolicyArchitecture) -> "PolicyNetwork":
        """Read weights from a safetensors file; nothing is ever unpickled.

        Raises:
            MissingExtraError: torch or safetensors is not installed.
            ModelError: The file is missing, of another format, or holds another network.
        """
        require("torch", extra=EXTRA)
        safetensors = require("safetensors", extra=EXTRA)
        reader = require("safetensors.torch", extra=EXTRA)
        try:
            weights = reader.load_file(str(path))
        except (OSError, safetensors.SafetensorError) as error:
            raise ModelError(
                f"{path} can't be read as safetensors ({error}); a checkpoint of "
                f"{architecture.name} is converted once by scripts/convert_policy.py"
            ) from error
        return PolicyNetwork(weights, architecture)

    def first_state(self) -> Any:
        """The state at the start of a search: zeros, ``(layers, hidden)``."""
        size = (self.architecture.state_layers, self.architecture.hidden)
        return self._torch.zeros(size)

    def step(
        self,
        rgb: UInt8[np.ndarray, "height width 3"],
        state: Any,
        *,
        last_action: int,
        goal: int | Float32[np.ndarray, "n"],
        pose: tuple[float, float, float] | None = None,
    ) -> tuple[Float32[np.ndarray, "actions"], Any]:
        """Scores of the actions, and the next state.

        Args:
            rgb: Camera image; it is shrunk to the policy's side and cropped to a square.
            state: State after the previous step.
            last_action: Number of the last action plus one; 0 at the start.
            goal: Number of the goal, or its vector.
            pose: GPS ``(x, z)``, metres, and compass, radians; None if the policy has no pose.

        Returns:
            Logits of the actions; state, which is a tensor.
        """
        torch, weights = self._torch, self._weights
        with torch.inference_mode():
            inputs = [self._see(self._prepared(rgb))]
            if pose is not None:
                x, z, heading = pose
                gps = torch.tensor([x, z], dtype=torch.float32)
                compass = torch.tensor([np.cos(heading), np.sin(heading)], dtype=torch.float32)
                inputs.append(self._linear("gps_embedding", gps))
                inputs.append(self._linear("compass_embedding", compass))
            if isinstance(goal, int):
                inputs.append(weights["goal_embedding.weight"][goal])
            else:
                inputs.append(torch.from_numpy(goal))
            inputs.append(weights["prev_action_embedding.weight"][last_action])
            state = self._remember(torch.cat(inputs), state)
            logits = self._linear("action", state[1])
        return logits.numpy(), state

    def _prepared(self, rgb: UInt8[np.ndarray, "height width 3"]) -> Any:
        """The middle of the image, normalised; ``(1, 3, side, side)``."""
        torch, side = self._torch, self.architecture.image_px
        image = torch.from_numpy(np.ascontiguousarray(rgb)).permute(2, 0, 1)[None].float()
        height, width = image.shape[2:]
        short = min(height, width)
        size = (height * side // short, width * side // short)
        # The published code of both resizes by torchvision, which then did not smooth by default.
        image = torch.nn.functional.interpolate(image, size=size, mode="bilinear").round()
        top, left = (size[0] - side) // 2, (size[1] - side) // 2
        image = image[:, :, top : top + side, left : left + side] / 255.0
        mean, variance = (self._weights[f"running_mean_and_var.{k}"] for k in ("_mean", "_var"))
        return (image - mean) * variance.clamp(min=_LEAST_VARIANCE).rsqrt()

    def _see(self, image: Any) -> Any:
        """The encoder's output for an image, a vector."""
        functional = self._torch.nn.functional
        x = functional.conv2d(image, self._weights["backbone.conv1.weight"], stride=2, padding=3)
        x = self._norm("backbone.bn1", x).relu()
        x = functional.max_pool2d(x, kernel_size=3, stride=2, padding=1)
        for layer, blocks in enumerate(BLOCKS):
            for block in range(blocks):
                stride = 2 if layer > 0 and block == 0 else 1
                x = self._bottleneck(f"backbone.layer{layer + 1}.{block}", x, stride)
        x = functional.conv2d(x, self._weights["compression.0.weight"], padding=1)
        x = self._norm("compression.1", x, groups=1).relu().flatten()
        last = len(self.architecture.visual) - 1
        for k in range(last):
            x = self._linear(f"visual_fc.{k}", x).relu()
        x = self._linear(f"visual_fc.{last}", x)
        return x.relu() if self.architecture.rectifies_last else x

    def _bottleneck(self, name: str, x: Any, stride: int) -> Any:
        functional, weights = self._torch.nn.functional, self._weights
        y = functional.conv2d(x, weights[f"{name}.conv1.weight"])
        y = self._norm(f"{name}.bn1", y).relu()
        y = functional.conv2d(y, weights[f"{name}.conv2.weight"], stride=stride, padding=1)
        y = self._norm(f"{name}.bn2", y).relu()
        y = self._norm(f"{name}.bn3", functional.conv2d(y, weights[f"{name}.conv3.weight"]))
        if f"{name}.downsample.0.weight" in weights:
            x = functional.conv2d(x, weights[f"{name}.downsample.0.weight"], stride=stride)
            x = self._norm(f"{name}.downsample.1", x)
        return (x + y).relu()

    def _norm(self, name: str, x: Any, groups: int = GROUPS) -> Any:
        weight, bias = self._weights[f"{name}.weight"], self._weights[f"{name}.bias"]
        return self._torch.nn.functional.group_norm(x, groups, weight, bias)

    def _linear(self, name: str, x: Any) -> Any:
        return self._weights[f"{name}.weight"] @ x + self._weights[f"{name}.bias"]

    def _remember(self, x: Any, state: Any) -> Any:
        """The next state of both recurrent layers."""
        outputs, cells = [], []
        for layer in range(2):
            if self.architecture.cell == "gru":
                x = self._gru(layer, x, state[layer])
            else:
                x, cell = self._lstm(layer, x, state[layer], state[2 + layer])
                cells.append(cell)
            outputs.append(x)
        return self._torch.stack(outputs + cells)

    def _gru(self, layer: int, x: Any, before: Any) -> Any:
        from_x, from_before = self._gates(layer, x, before, 3)
        reset = (from_x[0] + from_before[0]).sigmoid()
        keep = (from_x[1] + from_before[1]).sigmoid()
        new = (from_x[2] + reset * from_before[2]).tanh()
        return (1.0 - keep) * new + keep * before

    def _lstm(self, layer: int, x: Any, before: Any, cell: Any) -> tuple[Any, Any]:
        from_x, from_before = self._gates(layer, x, before, 4)
        enter, forget, new, leave = (a + b for a, b in zip(from_x, from_before, strict=True))
        cell = forget.sigmoid() * cell + enter.sigmoid() * new.tanh()
        return leave.sigmoid() * cell.tanh(), cell

    def _gates(self, layer: int, x: Any, before: Any, count: int) -> tuple[Any, Any]:
        weights = self._weights
        from_x = weights[f"rnn.weight_ih_l{layer}"] @ x + weights[f"rnn.bias_ih_l{layer}"]
        from_before = weights[f"rnn.weight_hh_l{layer}"] @ before
        from_before = from_before + weights[f"rnn.bias_hh_l{layer}"]
        return from_x.chunk(count), from_before.chunk(count)


def _check_shapes(weights: Mapping[str, Any], architecture: PolicyArchitecture) -> None:
    expected = architecture.shapes()
    found = {name: tuple(tensor.shape) for name, tensor in weights.items()}
    faults = [f"{name} is missing" for name in expected if name not in found]
    faults += [f"{name} is unknown" for name in found if name not in expected]
    faults += [
        f"{name} is {found[name]} instead of {shape}"
        for name, shape in expected.items()
        if found.get(name, shape) != shape
    ]
    if faults:
        more = f" and {len(faults) - _NAMED} more" if len(faults) > _NAMED else ""
        raise ModelError(
            f"this is no checkpoint of {architecture.name}: {', '.join(faults[:_NAMED])}{more}; "
            "convert the published file with scripts/convert_policy.py"
        )


def read_vectors(path: str, size: int) -> dict[str, Float32[np.ndarray, "n"]]:
    """Vectors of goals, by their names, each of length 1.

    Args:
        path: File of vectors, safetensors.
        size: Number of values of each vector.

    Raises:
        ConfigError: No file is named.
        MissingExtraError: safetensors is not installed.
        ModelError: The file can't be read, or holds something else.
    """
    if not path:
        raise ConfigError(
            "zson compares images with vectors of goals: name a file of them, safetensors with a "
            f"vector of {size} numbers (CLIP RN50, of the bare words) for each goal, "
            "--set policy.goals=FILE"
        )
    safetensors = require("safetensors", extra=EXTRA)
    reader = require("safetensors.numpy", extra=EXTRA)
    try:
        vectors = reader.load_file(path)
    except (OSError, safetensors.SafetensorError) as error:
        raise ModelError(f"{path} can't be read as safetensors: {error}") from error
    for name, vector in vectors.items():
        if vector.shape != (size,) or not np.linalg.norm(vector) > 0.0:
            raise ModelError(
                f"{path}: '{name}' has the shape {vector.shape}; expected a vector of "
                f"{size} numbers that are not all 0"
            )
    return {
        name: (vector / np.linalg.norm(vector)).astype(np.float32)
        for name, vector in vectors.items()
    }
