"""A study: a list of variants of a method, the first of which is the method itself."""

import re
from dataclasses import dataclass, replace
from functools import cached_property

from hypernav.build.choosing import ChosenComponents, choose_components
from hypernav.build.component_specs import ComponentSpecs, PresetName
from hypernav.build.presets import HyPerNavConfig
from hypernav.io.layered_config import layered


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
