"""The study of models: what a search is worth with reasoners and detectors of known quality."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from hypernav.core.errors import ConfigError
from hypernav.lab.evaluation.ablation.study import Axis, LeftOut, Method, Study, Variant
from hypernav.lab.evaluation.ablation.switches import switches
from hypernav.lab.evaluation.choices import StudyName
from hypernav.search.perception.local.stand_ins import noisy_detector

RATES = (0.0, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0)
"""Probabilities of the truly best block."""
LEVELS = tuple(reversed(noisy_detector.LEVELS))
"""Detectors, the worst first."""

_REASONER = "best block with probability P, else another"
_BEST = ("reasoner", "noisy:1")


def model_quality(method: Method) -> Study:
    """Variants with increasingly reliable reasoners, and with increasingly good detectors.

    Raises:
        ConfigError: The agent does not use both a reasoner and a detector.
    """
    chosen = method.chosen
    if chosen.reasoner is None or chosen.detector is None or not chosen.chooses_blocks:
        raise ConfigError(
            f"--agent {chosen.agent.spec} doesn't ask both a reasoner of blocks and a detector, so "
            "this study can't vary them; use hypernav"
        )
    plain = chosen.reasoner.spec == "geometric"
    unchanged = "geometric rule" if plain else f"reasoner {chosen.reasoner.spec}"
    seen_by = chosen.detector.spec
    unasked = (("reasoner", None),) if method.specs.reasoner else ()
    references = (
        Variant("random block", "Any block is named.", components=(("reasoner", "random"),)),
        Variant("nearest frontier", "No blocks.", components=(("agent", "frontier"), *unasked)),
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
            f"The detector errs as often as noisy:{level} does{more}.",
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
    first = Variant(unchanged, f"The preset {method.preset} with the options of the command.")
    variants, left_out = _distinct((first, *references, *rates, *levels), method)
    return Study(
        f"How good must the model be? The preset {method.preset}",
        variants,
        left_out,
        axes=(
            Axis(
                f"P: how often the best block is named ({seen_by} detector)",
                (_REASONER,),
                lines=(unchanged, *(one.name for one in references)),
            ),
            Axis("quality of the simulated detector (boxes only)", (unchanged, best), ticks=LEVELS),
        ),
    )


def _distinct(
    variants: Sequence[Variant], method: Method
) -> tuple[tuple[Variant, ...], tuple[LeftOut, ...]]:
    """The distinct variants, and those left out, with the reason.

    If the user's own method, which comes first, is a point of a curve, it takes that place.
    """
    kept: dict[tuple[tuple[str, str | None], ...], Variant] = {}
    left_out = []
    for variant in variants:
        try:
            parts = tuple(method.varied(variant).chosen.as_dict().items())
        except ConfigError as error:
            left_out.append(LeftOut(variant, str(error)))
            continue
        same = kept.setdefault(parts, variant)
        if same.name == variants[0].name != variant.name:
            left_out.append(LeftOut(variant, "it is so already"))
            if not same.curve:
                kept[parts] = replace(same, quality=variant.quality, curve=variant.curve)
        elif same is not variant:
            left_out.append(LeftOut(variant, f"it is the same as {same.name}"))
    return tuple(kept.values()), tuple(left_out)


STUDIES: dict[StudyName, Callable[[Method], Study]] = {"switches": switches, "model": model_quality}
