"""A study: a list of variants of a method, the first of which is the method itself.

Its results are read back from the folders of its variants.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from hypernav.app.build.components.choosing import ChosenComponents, choose_components
from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.naming.words import number_of
from hypernav.io.layered_config import layered
from hypernav.lab.evaluation.report.run_data import RunData, load_runs
from hypernav.lab.evaluation.report.tables import Pair, own_protocol, pair
from hypernav.lab.evaluation.statistics import Summary, holm, summarise
from hypernav.lab.evaluation.store.run_store import read_records


@dataclass(frozen=True)
class Method:
    """The method that a study varies.

    Attributes:
        preset: Preset that it is made from.
        config: The whole configuration, settings of the user included.
        specs: Components, as the user wrote them.
    """

    preset: PresetName
    config: HyPerNavConfig
    specs: ComponentSpecs

    @cached_property
    def chosen(self) -> ChosenComponents:
        """All components.

        Raises:
            ConfigError: They don't go together, or don't exist.
        """
        return choose_components(self.specs, presence=self.config.presence.enabled)

    def varied(self, variant: "Variant") -> "Method":
        """The method with the changes of a variant."""
        return Method(
            self.preset,
            layered(self.config, environment={}, assignments=variant.assignments),
            replace(self.specs, **dict(variant.components)),
        )


@dataclass(frozen=True)
class Variant:
    """One variant of a method.

    Attributes:
        name: Short name for people, unique in a study.
        words: The difference, in a sentence; it says where the paper leaves it open.
        assignments: Values that it sets, as ``--set`` takes them.
        components: Components that it replaces, as kind ("reasoner") and specification; None
            removes the user's choice.
        quality: Position on the axis of its curve; None for variants that are on no curve.
        curve: Name of the curve that it belongs to, in a study of quality.
    """

    name: str
    words: str
    assignments: tuple[str, ...] = ()
    components: tuple[tuple[str, str | None], ...] = ()
    quality: float | None = None
    curve: str = ""

    @property
    def slug(self) -> str:
        """Name without blanks, for its folder and the command line."""
        return slug(self.name)

    @property
    def changes(self) -> str:
        """Options of `hypernav eval` that make the variant; empty for the unchanged method."""
        options = [
            f"(no --{kind})" if spec is None else f"--{kind} {spec}"
            for kind, spec in self.components
        ]
        return " ".join([*options, *(f"--set {assignment}" for assignment in self.assignments)])


@dataclass(frozen=True)
class LeftOut:
    """A variant that a study leaves out because it could not differ from the method.

    Attributes:
        variant: The variant.
        why: The reason.
    """

    variant: Variant
    why: str


@dataclass(frozen=True)
class Axis:
    """A quality over which success and SPL are drawn.

    Attributes:
        words: Words below the axis.
        curves: Names of the curves over it.
        lines: Names of variants that are drawn as lines across it, for comparison.
        ticks: Names of the positions 0, 1, 2, …; empty for an axis of numbers.
    """

    words: str
    curves: tuple[str, ...]
    lines: tuple[str, ...] = ()
    ticks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Study:
    """Variants of a method, and how their results are drawn.

    Attributes:
        title: Title of the page.
        variants: The unchanged method, and its variants.
        left_out: Variants that make no difference here.
        axes: Axes of `Variant.quality`: success and SPL are drawn as curves over each of them.
            Empty: each variant's difference from the unchanged method is drawn.
    """

    title: str
    variants: tuple[Variant, ...]
    left_out: tuple[LeftOut, ...] = ()
    axes: tuple[Axis, ...] = ()


def slug(text: str) -> str:
    """A text as the name of a folder."""
    return re.sub(r"[^a-z0-9.]+", "-", text.lower()).strip("-.")


@dataclass(frozen=True)
class CorrectedP:
    """P-values of one comparison, corrected by Holm's method for all comparisons of the study.

    Attributes:
        success: P-value of the difference of success rates.
        spl: P-value of the difference of SPL.
    """

    success: float
    spl: float


@dataclass(frozen=True)
class VariantResult:
    """The results of one variant so far.

    Attributes:
        variant: The variant.
        run: Its records.
        summary: Mean results.
        pair: Comparison with the unchanged method on the episodes that both have done; None for
            the unchanged method itself.
        corrected: P-values of the comparison, corrected; None for the unchanged method itself.
    """

    variant: Variant
    run: RunData
    summary: Summary
    pair: Pair | None
    corrected: CorrectedP | None = None

    @property
    def is_whole(self) -> bool:
        """Whether all episodes are done, so that the means are those of the data set."""
        return len(self.run.records) >= self.run.wanted

    @property
    def label(self) -> str:
        """Name of the variant, with its progress if it is not finished."""
        if self.is_whole:
            return self.variant.name
        done = number_of(self.run.wanted, "episode")
        return f"{self.variant.name} ({len(self.run.records):,} of {done})"


@dataclass(frozen=True)
class StudyResults:
    """The results of a study so far.

    Attributes:
        study: The study.
        baseline: Results of the unchanged method.
        variants: Results of the others that have an episode in common with it, in the order of the
            study.
        waiting: Variants without results.
    """

    study: Study
    baseline: VariantResult
    variants: tuple[VariantResult, ...]
    waiting: tuple[Variant, ...]

    @property
    def all(self) -> tuple[VariantResult, ...]:
        """The unchanged method, then its variants."""
        return (self.baseline, *self.variants)

    @property
    def comparisons(self) -> int:
        """Number of the comparisons that are shown: of success and of SPL for every variant."""
        return 2 * len(self.variants)

    @property
    def worst_first(self) -> tuple[VariantResult, ...]:
        """The variants, greatest loss of SPL first."""

        def gain(result: VariantResult) -> tuple[float, float]:
            assert result.pair is not None
            differences = (result.pair.spl.difference, result.pair.success.difference)
            return (differences[0].mean, differences[1].mean)

        return tuple(sorted(self.variants, key=gain))


def read_results(folder: Path, study: Study) -> StudyResults | None:
    """Read the results of a study so far.

    Returns:
        The results; None as long as the unchanged method has none.

    Raises:
        RunFolderError: A folder is damaged.
    """
    first, *others = study.variants
    unchanged = _load(folder, first)
    if unchanged is None:
        return None
    baseline = VariantResult(first, unchanged, _summary(unchanged), None)
    results, waiting = [], []
    for variant in others:
        run = _load(folder, variant)
        compared = None if run is None else pair(unchanged, run)
        if run is None or compared is None or compared.count == 0:
            waiting.append(variant)
        else:
            results.append(VariantResult(variant, run, _summary(run), compared))
    return StudyResults(study, baseline, _corrected(results), tuple(waiting))


def _corrected(results: Sequence[VariantResult]) -> tuple[VariantResult, ...]:
    pairs = [result.pair for result in results if result.pair is not None]
    p_values = holm([gap.p_value for pair in pairs for gap in (pair.success, pair.spl)])
    return tuple(
        replace(result, corrected=CorrectedP(*p))
        for result, p in zip(results, zip(p_values[::2], p_values[1::2], strict=True), strict=True)
    )


def _load(folder: Path, variant: Variant) -> RunData | None:
    """The run of a variant; None as long as no episode of it counts."""
    own = folder / variant.slug
    if not any(record.counts for record in read_records(own)):
        return None
    return replace(load_runs([own])[0], name=variant.name)


def _summary(run: RunData) -> Summary:
    return summarise(run.records, own_protocol(run))
