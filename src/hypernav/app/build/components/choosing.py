"""Chooses the components: completes the user's choice, and refuses contradictions."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.construction import asked_by, section_of
from hypernav.app.build.components.registries import (
    AGENTS,
    DETECTORS,
    NATIVE_AGENTS,
    ROLES,
    SEGMENTERS,
    SIMILARITIES,
    Factory,
    Role,
)
from hypernav.app.build.native import step_limit_of
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.components.abilities import gives_masks
from hypernav.core.components.registry import Choice, Registry
from hypernav.core.errors import ConfigError

_EXAMPLE = "--vlm openai:http://localhost:8000/v1"


@dataclass(frozen=True)
class ChosenComponents:
    """The complete choice of components. Those that are None are not used.

    Attributes:
        agent: Agent, or explorer of the search.
        vlm: Specification of the chat model.
        detector: Detector of the goal.
        reasoner: Reasoner that the agent asks where to go, or what a view is worth.
        segmenter: Segmenter of the pixels in a box; None if detections carry their masks.
        presence: Whether the chat model checks the presence of the goal before STOP.
        native: Whether the agent has its own stop and moves.
        similarity: Model that compares key images of a memory with the goal's words.
    """

    agent: Choice[Factory]
    vlm: str | None
    detector: Choice[Factory] | None
    reasoner: Choice[Factory] | None
    segmenter: Choice[Factory] | None
    presence: bool
    native: bool = False
    similarity: Choice[Factory] | None = None

    @property
    def by_kind(self) -> dict[str, Choice[Factory]]:
        """All components in use, each after those that it is made of."""
        return {
            kind: choice
            for kind in ("detector", "segmenter", "similarity", "reasoner", "agent")
            if (choice := getattr(self, kind)) is not None
        }

    @property
    def reasoner_role(self) -> str:
        """Name by which the agent asks for its reasoner; empty if it asks for none."""
        return role_in(asked_by(self.agent))

    @property
    def chooses_blocks(self) -> bool:
        """Whether a reasoner is asked which block of the map to visit."""
        return self.reasoner_role == "reasoner"

    @property
    def is_whole_agent(self) -> bool:
        """Whether it is a whole agent, not an explorer for the search of this package."""
        return hasattr(self.agent.load(), "act")

    def as_dict(self) -> dict[str, str | None]:
        """Specifications that choose the same components again, for ``result.json``."""
        native = {"mode": "native"} if self.native else {}
        similarity = {} if self.similarity is None else {"similarity": self.similarity.spec}
        return {
            "agent": self.agent.spec,
            "vlm": self.vlm,
            "detector": "none" if self.detector is None else self.detector.spec,
            "reasoner": "none" if self.reasoner is None else self.reasoner.spec,
            "segmenter": "none" if self.segmenter is None else self.segmenter.spec,
            "presence": "vlm" if self.presence else "none",
            **native,
            **similarity,
        }


def choose_components(specs: ComponentSpecs, *, presence: bool = True) -> ChosenComponents:
    """Complete the user's choice, and refuse contradictions.

    A chat model, if there is one, detects, chooses blocks and checks the presence of the goal,
    unless another component is named for one of these.

    Args:
        specs: Specifications of the user.
        presence: Whether a chat model, if there is one, checks the presence of the goal before
            STOP.

    Raises:
        ConfigError: Components do not fit together, or do not exist; the message lists which do.
        ContractError: A component of another package can't be built.
    """
    if specs.native:
        step_limit_of(specs.agent)
    model = specs.vlm is not None
    has_own = specs.native and NATIVE_AGENTS.knows(specs.agent)
    agent = (NATIVE_AGENTS if has_own else AGENTS).find(specs.agent)
    asked = set(asked_by(agent))
    drives_itself = hasattr(agent.load(), "act")
    if not drives_itself:
        asked |= {"detector", "segmenter", "similarity"}
    by_model = "vlm" if model else None
    detector = _choice(DETECTORS, specs.detector, by_model or "ground-truth", agent, asked)
    reasoner = _reasoner(ROLES.get(role_in(asked)), specs.reasoner, by_model, agent)
    segmenter = _choice(SEGMENTERS, specs.segmenter, "depth-cut", agent, asked)
    similarity = None
    if specs.similarity is not None:
        similarity = _choice(SIMILARITIES, specs.similarity, "", agent, asked)
    # A whole agent gets the segmenter that it asks for, whatever it uses it for.
    if not drives_itself and detector and segmenter and gives_masks(detector.load()):
        if segmenter.spec != "depth-cut":
            raise ConfigError(
                f"--segmenter {segmenter.spec} would never be asked: {detector.spec} detections "
                "carry their own masks; choose another --detector or drop --segmenter"
            )
        segmenter = None
    looks_once_more = model and presence and not drives_itself
    chosen = ChosenComponents(
        agent,
        specs.vlm,
        detector,
        reasoner,
        segmenter,
        looks_once_more,
        specs.native,
        similarity,
    )
    _check_model(chosen)
    return chosen


def role_in(asked: Collection[str]) -> str:
    """The role of a reasoner among the parameters; empty if there is none."""
    return next((name for name in ROLES if name in asked), "")


def with_own_sections(config: HyPerNavConfig, chosen: ChosenComponents) -> HyPerNavConfig:
    """The configuration with the complete sections of components from other packages.

    Raises:
        ConfigError: ``own`` holds values for no component in use, or impossible ones.
        ContractError: A component doesn't say what its section holds.
    """
    own: dict[str, Any] = {}
    for kind in type(config.own).model_fields:
        choice = chosen.by_kind.get(kind)
        if choice is not None:
            section = section_of(choice, kind, config)
            if choice.entry.is_foreign and section is not None:
                own[kind] = section.model_dump(mode="json")
        elif getattr(config.own, kind):
            raise ConfigError(f"own.{kind}: no {kind} is asked here, so there is none to configure")
    return config.model_copy(update={"own": config.own.model_copy(update=own)})


def _choice(
    registry: Registry[Factory],
    spec: str | None,
    default: str,
    agent: Choice[Factory],
    asked: set[str],
) -> Choice[Factory] | None:
    """A component, if the agent asks for one of this kind."""
    if registry.kind in asked:
        return registry.find(spec or default)
    if spec is not None:
        raise ConfigError(_needless(registry.kind, spec, agent))
    return None


def _reasoner(
    role: Role | None, spec: str | None, by_model: str | None, agent: Choice[Factory]
) -> Choice[Factory] | None:
    """The reasoner for the agent's role."""
    if role is not None:
        return role.registry.find(spec or by_model or role.without_model)
    if spec is not None:
        raise ConfigError(_needless("reasoner", spec, agent))
    return None


def _needless(kind: str, spec: str, agent: Choice[Factory]) -> str:
    return (
        f"--agent {agent.spec} asks no {kind}, so --{kind} {spec} has no "
        "meaning; drop it or use --agent hypernav"
    )


def _check_model(chosen: ChosenComponents) -> None:
    """Make sure that no component lacks a chat model, and that a chat model is used."""
    asking = {kind: asked_by(choice) for kind, choice in chosen.by_kind.items()}
    for kind, choice in chosen.by_kind.items():
        if chosen.vlm is None and asking[kind].get("chat", False):
            raise ConfigError(
                f"--{kind} {choice.spec} needs a chat model; name it, for example {_EXAMPLE}"
            )
    is_asked = chosen.presence or any("chat" in asked for asked in asking.values())
    if chosen.vlm is not None and not is_asked:
        named = ", ".join(f"--{kind} {choice.spec}" for kind, choice in chosen.by_kind.items())
        raise ConfigError(
            f"--vlm {chosen.vlm} would never be asked: {named}, presence.enabled=false; give it "
            "something to do or drop --vlm"
        )
