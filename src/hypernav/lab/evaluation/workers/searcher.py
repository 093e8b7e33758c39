"""Who runs a worker's episodes: the configured agent, or one of a user's own."""

from collections.abc import Callable
from dataclasses import dataclass

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.show.captions import ITS_OWN
from hypernav.core.components.abilities import looks_at_colours
from hypernav.core.components.door import calling, through_door
from hypernav.core.components.protocols import Agent
from hypernav.core.episode import EpisodeTruth
from hypernav.lab.evaluation.workers.job import factory_name


@dataclass(frozen=True)
class Searcher:
    """Who searches.

    Attributes:
        agent: The agent.
        words: Who in it sees and thinks, for people.
        looks_at_colours: Whether it looks at colours.
        whole: The agent with all that it was built of, to be closed.
        truth: What stand-ins in it are told of the truth; None if it has none.
    """

    agent: Agent
    words: dict[str, str]
    looks_at_colours: bool
    whole: object
    truth: EpisodeTruth | None = None


def searcher_of(
    config: HyPerNavConfig, specs: ComponentSpecs, make_agent: Callable[[], Agent] | None
) -> Searcher:
    """Build who searches.

    Raises:
        HyPerNavError: The agent can't be built.
    """
    if make_agent is not None:
        name = factory_name(make_agent)
        with calling(name, "its call"):
            agent = make_agent()
        agent = through_door(agent, Agent, name)
        kinds = ("detector", "reasoner", "segmenter")
        words = {"agent": type(agent).__name__} | dict.fromkeys(kinds, ITS_OWN)
        return Searcher(agent, words, looks_at_colours(agent), whole=agent)
    parts = build_agent(config, specs)
    words = {
        "agent": specs.name,
        "detector": parts.detector_words,
        "reasoner": parts.reasoner_words,
        "segmenter": parts.segmenter.words,
    }
    return Searcher(parts.agent, words, parts.looks_at_colours, parts, parts.truth)
