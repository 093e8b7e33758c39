"""Builds agents from a configuration."""

from pathlib import Path
from typing import Any

from hypernav.app.build.built_agent import BuiltAgent
from hypernav.app.build.components.chat import is_named, model_words, wrap_chat
from hypernav.app.build.components.choosing import choose_components, role_in
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.construction import asked_by, build
from hypernav.app.build.components.fingerprints import given_files, prompt_hashes
from hypernav.app.build.components.registries import AGENTS, ROLES, Factory
from hypernav.app.build.components.stand_ins import beside_published, segmenter_words, unmeasured
from hypernav.app.build.native import check_native_robot
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.show.captions import ITS_OWN
from hypernav.core.components.abilities import ChecksModel, wants_named_things
from hypernav.core.components.door import through_door
from hypernav.core.components.protocols import (
    Agent,
    Detector,
    Explorer,
    ImageTextModel,
    PresenceCheck,
    Segmenter,
)
from hypernav.core.components.registry import Choice
from hypernav.core.episode import EpisodeTruth
from hypernav.core.errors import ConfigError
from hypernav.core.trace import ExchangeLog
from hypernav.search.agents.search import SearchAgent
from hypernav.search.agents.step import SearchComponents
from hypernav.search.models.chat.ledger import Ledger
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.image_recall import ImageRanking, ImageRecall
from hypernav.search.perception.local.depth_cut import DepthCutSegmenter
from hypernav.search.perception.local.local_perception import LocalPerception
from hypernav.search.perception.local.yes_no_checks import VlmPresenceCheck

_PROTOCOLS = {"detector": Detector, "segmenter": Segmenter, "similarity": ImageTextModel}


def build_agent(
    config: HyPerNavConfig,
    specs: ComponentSpecs | None = None,
    *,
    record: Path | None = None,
    resume: bool = False,
) -> BuiltAgent:
    """Put an agent together.

    Args:
        config: Configuration of everything.
        specs: Specifications of the components; without a model by default.
        record: File for every exchange with the chat model; None records nothing.
        resume: Whether to answer recorded questions from that file.

    Raises:
        ConfigError: Components do not exist, do not fit together or would never be asked, or native
            mode is combined with the robot of common mode.
        ContractError: A component of another package breaks its protocol.
        ModelError: A model's file cannot be used.
        RecordingError: A recording is missing or broken, or a file with its name exists.
        MissingExtraError: A component needs a package that is not installed.
    """
    chosen = choose_components(specs or ComponentSpecs(), presence=config.presence.enabled)
    if chosen.similarity is not None and not config.search.recall:
        raise ConfigError(
            f"--similarity {chosen.similarity.spec} would never be asked: it ranks the images of a "
            "memory, and with search.recall=false (as in --preset paper) no search goes to what is "
            "remembered; set search.recall=true or drop --similarity"
        )
    if chosen.native:
        check_native_robot(config)
    log, ledger, truth = ExchangeLog(), Ledger(), EpisodeTruth()
    chat, recording = wrap_chat(chosen.vlm, config.chat, ledger, record, resume=resume)
    built: dict[str, Any] = {}
    for kind, choice in chosen.by_kind.items():
        offers = _offers(config, log) | built | {"truth": truth}
        if chat is not None:
            offers["chat"] = chat
        role = chosen.reasoner_role if kind == "reasoner" else kind
        built[role] = _made(choice, role, config, offers)
    detector, agent = built.get("detector"), built["agent"]
    if chosen.vlm is not None and is_named(chosen.vlm) and isinstance(detector, ChecksModel):
        detector.check_model()  # refuse it now, not at the first step
    presence = VlmPresenceCheck(chat, log, config.presence) if chat and chosen.presence else None
    image_recall = ImageRecall(chat, log, config.image_recall) if chat else None
    image_ranking = None
    if chosen.similarity is not None:
        name, least = chosen.similarity.words(), config.image_recall.least_similarity
        image_ranking = ImageRanking(built["similarity"], log, name, least)
    if not chosen.is_whole_agent:
        agent = _search(
            config,
            built["detector"],
            log,
            explorer=agent,
            segmenter=built.get("segmenter"),
            presence=presence,
            image_recall=image_recall,
            image_ranking=image_ranking,
        )
    model = "" if chat is None or chosen.vlm is None else model_words(chosen.vlm, chat.identify)
    detector_words = chosen.detector.words(model=model) if chosen.detector else ITS_OWN
    parts = (*built.values(), presence, image_recall, recording)
    published = config.local.published_segmenter
    return BuiltAgent(
        agent=agent,
        chosen=chosen,
        detector_words=detector_words,
        reasoner_words=(chosen.reasoner or chosen.agent).words(model=model),
        segmenter=segmenter_words(chosen, published, detector_words=detector_words, model=model),
        model_words=beside_published(chosen, config.chat.published_model, model),
        components=tuple(one for one in parts if one is not None),
        files=given_files(chosen, config),
        ledger=ledger,
        price=config.price,
        prompts={} if chosen.vlm is None else prompt_hashes(config),
        truth=truth,
        detector_warning=unmeasured(chosen, detector, config.local),
    )


def build_search(
    config: HyPerNavConfig,
    detector: Detector,
    log: ExchangeLog | None = None,
    *,
    agent: str = "hypernav",
    segmenter: Segmenter | None = None,
    reasoner: object | None = None,
    presence: PresenceCheck | None = None,
    image_recall: ImageRecall | None = None,
    image_ranking: ImageRanking | None = None,
) -> SearchAgent:
    """Build an agent around existing components, for example a detector of your own.

    Args:
        config: Configuration of everything.
        detector: Detector of the goal.
        log: Log of the questions to detector and reasoner, if they keep one.
        agent: Name of an explorer.
        segmenter: Segmenter of the pixels in a box; by default the cut by depth.
        reasoner: Reasoner that the explorer asks; by default the one that needs no model.
        presence: Presence check before STOP; None makes no check.
        image_recall: Question about the images of a memory; None asks none.
        image_ranking: Ranking of these images by a model that compares them with the goal's words.
    """
    log = log or ExchangeLog()
    return _search(
        config,
        through_door(detector, Detector),
        log,
        explorer=build_explorer(config, log, agent, reasoner=reasoner),
        segmenter=None if segmenter is None else through_door(segmenter, Segmenter),
        presence=None if presence is None else through_door(presence, PresenceCheck),
        image_recall=image_recall,
        image_ranking=image_ranking,
    )


def build_explorer(
    config: HyPerNavConfig,
    log: ExchangeLog,
    agent: str,
    *,
    reasoner: object | None = None,
) -> Explorer:
    """Build only an explorer.

    Args:
        config: Configuration of everything.
        log: Log of its questions.
        agent: Name of the explorer.
        reasoner: Reasoner that it asks; by default the one that needs no model.
    """
    offers = _offers(config, log)
    choice = AGENTS.find(agent)
    if role := role_in(asked_by(choice)):
        stand_in = ROLES[role].registry.find(ROLES[role].without_model)
        offers[role] = (
            _made(stand_in, role, config, offers)
            if reasoner is None
            else through_door(reasoner, ROLES[role].protocol)
        )
    return _made(choice, "agent", config, offers)


def _search(
    config: HyPerNavConfig,
    detector: Detector,
    log: ExchangeLog,
    *,
    explorer: Explorer,
    segmenter: Segmenter | None,
    presence: PresenceCheck | None,
    image_recall: ImageRecall | None,
    image_ranking: ImageRanking | None,
) -> SearchAgent:
    """The search of this package around an explorer."""
    components = SearchComponents(
        mapping=config.mapping,
        local=LocalPerception(
            detector,
            segmenter or DepthCutSegmenter(config.depth_cut),
            config.local.for_detector(detector),
            config.embodiment.camera,
            cell_size_m=config.mapping.cell_size_m,
            names_things=wants_named_things(explorer),
            tells_floors=config.search.use_stairs and config.embodiment.body.climbs_stairs,
        ),
        explorer=explorer,
        planning=config.planning,
        embodiment=config.embodiment,
        presence=presence,
        image_recall=image_recall,
        image_ranking=image_ranking,
        log=log,
        config=config.search,
    )
    return SearchAgent(components)


def _offers(config: HyPerNavConfig, log: ExchangeLog) -> dict[str, Any]:
    """Arguments for the constructors of all components."""
    return {
        "log": log,
        "embodiment": config.embodiment,
        "mapping": config.mapping,
        "prompted": config.prompted,
        "clearances_m": config.planning.clearances_m(config.embodiment.body),
        "fallback": GeometricReasoner(log, config.geometric),
    }


def _made(
    choice: Choice[Factory], role: str, config: HyPerNavConfig, offers: dict[str, Any]
) -> Any:
    """Build a component for its role (its kind, unless a reasoner), and let it through the door."""
    kind = "reasoner" if role in ROLES else role
    return build(choice, kind, _protocol_of(choice, role), config, offers)


def _protocol_of(choice: Choice[Factory], role: str) -> type:
    if role in ROLES:
        return ROLES[role].protocol
    return _PROTOCOLS.get(role) or (Agent if hasattr(choice.load(), "act") else Explorer)
