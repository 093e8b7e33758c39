"""Convert a published checkpoint of PIRLNav or ZSON to safetensors, once, apart from hypernav.

Checkpoints are pickled, and unpickling runs what a file says. So this script is no part of the
package, and it builds nothing from a file but tensors and plain containers: any other class becomes
an empty stand-in. Run it where nothing is lost, for example in a container without network:

    pip install torch safetensors
    python scripts/convert_policy.py pirlnav objectnav_rl_ft_hd.ckpt pirlnav.safetensors

Names of weights are those of the published code (Ram81/pirlnav: ``pirlnav/policy``; gunagg/zson:
``zson/policy.py``, ``zson/visual_encoder.py``). Where a checkpoint's differ, the script says which
it doesn't know, and --rename OLD=NEW says what they are.
"""

import argparse
import pickle
import sys
import types
from collections.abc import Iterable
from pathlib import Path
from typing import Any

PREFIX = "actor_critic."
SHARED = (
    ("net.visual_encoder.backbone.", "backbone."),
    ("net.visual_encoder.compression.", "compression."),
    ("net.prev_action_embedding.", "prev_action_embedding."),
    ("net.state_encoder.rnn.", "rnn."),
    ("action_distribution.linear.", "action."),
)
RENAMED = {
    "pirlnav": (
        ("net.visual_encoder.running_mean_and_var.", "running_mean_and_var."),
        ("net.visual_fc.1.", "visual_fc.0."),
        ("net.obj_categories_embedding.", "goal_embedding."),
        ("net.gps_embedding.", "gps_embedding."),
        ("net.compass_embedding.", "compass_embedding."),
        *SHARED,
    ),
    "zson": (
        ("net.visual_encoder.normalize.", "running_mean_and_var."),
        ("net.policy_mlp.0.", "visual_fc.0."),
        ("net.policy_mlp.2.", "visual_fc.1."),
        *SHARED,
    ),
}
"""Beginnings of names in the checkpoints of each policy, and in converted files."""
LEFT_OUT = (
    "critic.",
    "aux_loss",
    "net.visual_encoder.running_mean_and_var._count",
    "net.visual_encoder.normalize._count",
)
"""Beginnings of names that driving needs not."""
_SAFE = {
    ("collections", "OrderedDict"),
    ("torch._utils", "_rebuild_tensor_v2"),
    ("torch._utils", "_rebuild_parameter"),
    ("torch", "FloatStorage"),
    ("torch", "LongStorage"),
    ("torch", "DoubleStorage"),
    ("torch", "HalfStorage"),
    ("torch", "IntStorage"),
    ("torch", "BoolStorage"),
    ("torch.storage", "UntypedStorage"),
    ("torch.storage", "TypedStorage"),
}
"""All that a file may name; `torch.load` itself gives the storages their content."""


class StandIn(dict):
    """Takes the place of any object that isn't a tensor or a plain container."""

    def __init__(self, *_: Any, **__: Any) -> None:
        """Ignore what it is made from."""
        super().__init__()

    def __setstate__(self, _: Any) -> None:
        """Ignore its content."""

    def __call__(self, *_: Any, **__: Any) -> "StandIn":
        """Another stand-in, for what a function would have given."""
        return StandIn()

    def append(self, _: Any) -> None:
        """Ignore an element."""

    extend = append


class SafeUnpickler(pickle.Unpickler):
    """Finds nothing but what `_SAFE` names."""

    def find_class(self, module: str, name: str) -> Any:
        """The class of a name, or the stand-in for it."""
        return super().find_class(module, name) if (module, name) in _SAFE else StandIn


def read_checkpoint(path: Path) -> dict[str, Any]:
    """The tensors of a checkpoint, by their names.

    Raises:
        SystemExit: It holds no state dict.
    """
    import torch

    safe = types.ModuleType("safe_pickle")
    safe.Unpickler = SafeUnpickler  # type: ignore[attr-defined]
    safe.load = lambda file, **options: SafeUnpickler(file, **options).load()  # type: ignore[attr-defined]
    content = torch.load(path, map_location="cpu", pickle_module=safe, weights_only=False)
    states = content.get("state_dict") if isinstance(content, dict) else None
    if not isinstance(states, dict):
        sys.exit(f"{path} holds no 'state_dict'; is it a checkpoint of habitat-baselines?")
    return {name: tensor for name, tensor in states.items() if isinstance(tensor, torch.Tensor)}


def converted_names(
    policy: str, names: Iterable[str], extra: Iterable[tuple[str, str]] = ()
) -> dict[str, str]:
    """Names in the converted file by those in a checkpoint, without what is left out.

    Args:
        policy: Name of the policy.
        names: Names in the checkpoint.
        extra: Further beginnings, and what replaces them; they come first.

    Raises:
        SystemExit: Some name begins like none that is known.
    """
    found, unknown = {}, []
    for name in names:
        bare = name.removeprefix(PREFIX)
        for old, new in (*extra, *RENAMED[policy]):
            if bare.startswith(old) and not bare.startswith(LEFT_OUT):
                if new:
                    found[name] = new + bare.removeprefix(old)
                break
        else:
            if not bare.startswith(LEFT_OUT):
                unknown.append(bare)
    if unknown:
        sys.exit(
            "the beginnings of these names are unknown; say what they are with --rename OLD=NEW, "
            f"or OLD= to leave them out: {', '.join(unknown)}"
        )
    return found


def _renaming(text: str) -> tuple[str, str]:
    old, equals, new = text.partition("=")
    if not (old and equals):
        raise argparse.ArgumentTypeError(f"'{text}': expected OLD=NEW")
    return old, new


def main() -> None:
    """Convert one file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("policy", choices=tuple(RENAMED))
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--rename", type=_renaming, action="append", default=[])
    options = parser.parse_args()
    from safetensors.torch import save_file

    tensors = read_checkpoint(options.checkpoint)
    names = converted_names(options.policy, tensors, options.rename)
    # Copies, because safetensors refuses tensors that share their memory.
    weights = {new: tensors[old].float().contiguous().clone() for old, new in names.items()}
    save_file(weights, options.output, metadata={"policy": options.policy})
    size = sum(tensor.numel() for tensor in weights.values()) / 1e6
    print(f"{options.output}: {len(weights)} tensors, {size:.1f} million numbers")


if __name__ == "__main__":
    main()
