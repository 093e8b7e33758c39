"""The study of models: what a search is worth with reasoners and detectors of known quality."""

from hypernav.core.errors import ConfigError
from hypernav.evaluation.ablation.study import Axis, LeftOut, Method, Study, Variant
from hypernav.perception.local.noisy_detector import NoisyDetectorConfig

RATES = (0.0, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0)
"""Probabilities of the truly best block."""
LEVELS = tuple(reversed(NoisyDetectorConfig.model_fields))
"""Detectors, the worst first."""

_REASONER = "best block with probability P, else another"
_BEST = ("reasoner", "noisy:1")


def model_quality(method: Method) -> Study:
    """Reasoners that name the truly best block ever more often, and ever better detectors.

    Raises:
        ConfigError: The agent asks no reasoner, so none can be better.
    """
    chosen = method.chosen
    if chosen.reasoner is None or chosen.detector is None:
        raise ConfigError(
            f"--agent {chosen.agent.spec} doesn't ask both a reasoner and a detector, so this "
            "study can't vary them; use hypernav"
        )
    plain = chosen.reasoner.spec == "geometric"
    unchanged = "geometric rule" if plain else f"reasoner {chosen.reasoner.spec}"
    seen_by = chosen.detector.spec
    references = (
        Variant("random block", "Any block is named.", components=(("reasoner", "random"),)),
        Variant("nearest frontier", "No blocks.", components=(("agent", "frontier"),)),
    )
    rates = [
        Variant(
            f"P = {rate:g}",
            f"The truly best block is named with probability {rate:g}, else another one.",
            components=(("reasoner", f"noisy:{rate:g}"),),
            quality=rate,
            curve=_REASONER,
        )
        for rate in RATES
    ]
    best = f"truly best block ({rates[-1].name})"
    levels = [
        Variant(
            f"{level} detector{suffix}",
            f"The detector errs as the level '{level}' of the section noisy_detector says{more}.",
            components=(("detector", f"noisy:{level}"), *extra),
            quality=float(place),
            curve=curve,
        )
        for curve, suffix, more, extra in (
            (unchanged, "", "", ()),
            (best, f", {rates[-1].name}", ", and the truly best block is named", (_BEST,)),
        )
        for place, level in enumerate(LEVELS)
    ]
    variants = [Variant(unchanged, f"The preset {method.preset} with the options of the command.")]
    left_out = []
    for variant in (*references, *rates, *levels):
        if why := _impossible(variant, method):
            left_out.append(LeftOut(variant, why))
        else:
            variants.append(variant)
    return Study(
        f"How good must the model be? The preset {method.preset}",
        tuple(variants),
        tuple(left_out),
        axes=(
            Axis(
                f"P: how often the best block is named ({seen_by} detector)",
                (_REASONER,),
                lines=(unchanged, *(one.name for one in references)),
            ),
            Axis("quality of the simulated detector (boxes only)", (unchanged, best), ticks=LEVELS),
        ),
    )


def _impossible(variant: Variant, method: Method) -> str:
    """The reason why the components of a variant don't go together; empty if they do."""
    try:
        _ = method.varied(variant).chosen
    except ConfigError as error:
        return str(error)
    return ""
