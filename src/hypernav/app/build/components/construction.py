"""Builds a component; the names of its constructor's parameters select the arguments.

Arguments after the component's name on the command line come first, by position: ``yolox:net.onnx``
makes ``YoloxDetector("net.onnx", ...)``. All others are optional and passed by name:

==============  ==================================================================================
name            what
==============  ==================================================================================
config          the component's own section of the configuration
log             `hypernav.core.trace.ExchangeLog`: what is written there is shown in the trace
chat            `hypernav.core.components.protocols.ChatModel` of ``--vlm``; required if no default
embodiment      `hypernav.core.embodiment.Embodiment`: what the robot is
mapping         `hypernav.search.mapping.config.MappingConfig`: cells and blocks of the map
clearances_m    how far from obstacles destinations lie, metres, in the order to try
fallback        for reasoners: a reasoner that needs no model
prompted        `hypernav.search.rivals.config.PromptedConfig`: budget and stop
truth           `hypernav.core.episode.EpisodeTruth`: for stand-ins, in simulation only
reasoner        for agents: the `BlockReasoner` of ``--reasoner``
scorer          for agents: the `SceneScorer` of ``--reasoner``
guide           for agents: the `Guide` of ``--reasoner``
arrow_reasoner  for agents: the `ArrowReasoner` of ``--reasoner``
detector        for agents: the `Detector` of ``--detector``
segmenter       for agents: the `Segmenter` of ``--segmenter``
similarity      for agents: the `ImageTextModel` of ``--similarity``
==============  ==================================================================================

The section of a component of another package is the pydantic model that annotates its parameter
``config``; values are set under ``own``: ``--set own.detector.threshold=0.3``.
"""

import inspect
from collections.abc import Mapping
from typing import Any, get_args, get_type_hints

from pydantic import BaseModel

from hypernav.app.build.components.registries import Factory
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.components.door import calling, through_door
from hypernav.core.components.registry import Choice
from hypernav.core.errors import ConfigError, ContractError
from hypernav.io.layered_config import read_section


def build(
    choice: Choice[Factory],
    kind: str,
    protocol: type,
    config: HyPerNavConfig,
    offers: Mapping[str, Any],
) -> Any:
    """Make a component with its section of the configuration, and let it through the door.

    Of several that are used together each goes through it.

    Args:
        choice: Component and its arguments.
        kind: Its kind, under which ``own`` holds the section of another package's component.
        protocol: Protocol of the kind.
        config: Configuration of everything.
        offers: Further arguments that its constructor may take.

    Raises:
        HyPerNavError: See `make` and `section_of`.
    """
    if choice.parts:
        parts = [build(one, kind, protocol, config, offers) for one in choice.parts]
        return choice.load()(*parts)
    section = section_of(choice, kind, config)
    component = make(choice, offers if section is None else {**offers, "config": section})
    return through_door(component, protocol, f"--{kind} {choice.spec}")


def asked_by(choice: Choice[Factory]) -> dict[str, bool]:
    """Names of the parameters of a component's constructor, and whether each is required.

    Raises:
        ConfigError: The specification has more arguments than the constructor takes.
        ContractError: The component is neither a class nor a function.
        ImportTargetError: It cannot be imported.
    """
    if choice.parts:
        asked = [asked_by(one) for one in choice.parts]
        return {name: any(one.get(name, False) for one in asked) for one in asked for name in one}
    factory = choice.load()
    if not callable(factory):
        raise ContractError(f"{choice.spec}: expected a class or a function, found {factory!r:.60}")
    try:
        signature = inspect.signature(factory)
    except (TypeError, ValueError) as error:
        raise ContractError(
            f"{choice.spec}: expected a class or a function of your own, whose parameters can be "
            f"read ({error})"
        ) from error
    parameters = [
        parameter
        for parameter in signature.parameters.values()
        if parameter.kind not in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD)
    ]
    taken = len(choice.arguments)
    if taken > sum(one.kind is not one.KEYWORD_ONLY for one in parameters):
        raise ConfigError(
            f"{choice.spec}: its constructor takes nothing by position, so nothing can follow its "
            "name"
        )
    return {one.name: one.default is one.empty for one in parameters[taken:]}


def make(choice: Choice[Factory], offers: Mapping[str, Any]) -> Any:
    """Make a component.

    Args:
        choice: Component and its arguments.
        offers: Arguments that its constructor may take.

    Raises:
        ComponentError: The constructor fails.
        ContractError: The constructor has another parameter without a default.
        ImportTargetError: It cannot be imported.
    """
    asked = asked_by(choice)
    unknown = [name for name, is_needed in asked.items() if is_needed and name not in offers]
    if unknown:
        raise ContractError(
            f"{choice.spec}: its constructor asks for '{unknown[0]}'; it may ask for "
            f"{', '.join(sorted(offers))}, and everything else needs a default"
        )
    named = {name: offers[name] for name in asked if name in offers}
    if not choice.entry.is_foreign:
        return choice.load()(*choice.arguments, **named)
    with calling(choice.spec, "its constructor"):
        return choice.load()(*choice.arguments, **named)


def section_of(choice: Choice[Factory], kind: str, config: HyPerNavConfig) -> BaseModel | None:
    """The section of the configuration that a component reads; None if it has none.

    Raises:
        ConfigError: ``own`` holds values that the component doesn't know, or can't use.
        ContractError: The component doesn't say what its section holds.
    """
    values: dict[str, Any] = getattr(config.own, kind, {})  # none for a similarity
    if choice.entry.is_foreign and "config" in asked_by(choice):
        return read_section(_section_model(choice), values, section=f"own.{kind}")
    if values:
        section = choice.entry.section
        remedy = f"its section is '{section}'" if section else "it has nothing to configure"
        raise ConfigError(f"own.{kind} is not for {choice.spec}; {remedy}")
    return getattr(config, choice.entry.section) if choice.entry.section else None


def _section_model(choice: Choice[Factory]) -> type[BaseModel]:
    factory = choice.load()
    try:
        hints = get_type_hints(factory.__init__ if isinstance(factory, type) else factory)
    except NameError as error:
        raise ContractError(
            f"{choice.spec}: the annotations of its parameters cannot be read ({error}); import "
            "what they name at run time, not under TYPE_CHECKING only"
        ) from error
    annotation = hints.get("config")
    for model in (annotation, *get_args(annotation)):
        if isinstance(model, type) and issubclass(model, BaseModel):
            return model
    raise ContractError(
        f"{choice.spec}: its parameter 'config' says nothing about what can be configured; "
        "annotate it with a class of yours, derived from hypernav.core.config.RoomConfig"
    )
