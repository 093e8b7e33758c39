"""An agent together with its components."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hypernav.app.build.components.choosing import ChosenComponents
from hypernav.app.build.components.stand_ins import SegmenterWords, labels_warning, reasoner_warning
from hypernav.app.build.presets import PriceConfig
from hypernav.core.components.abilities import (
    ChecksGoal,
    Closes,
    Reports,
    looks_at_colours,
    warning_of,
)
from hypernav.core.components.protocols import (
    Agent,
    Detector,
    Guide,
    ImageTextModel,
    SceneScorer,
    Segmenter,
)
from hypernav.core.episode import EpisodeTruth
from hypernav.core.goal import Goal
from hypernav.search.models.chat.ledger import Ledger


@dataclass(frozen=True)
class BuiltAgent:
    """An agent with its components and the ledger of its chat model.

    Attributes:
        agent: Agent, ready for `reset`.
        chosen: Choices that it was built from.
        detector_words: Name of the detector for people.
        reasoner_words: Name of the reasoner or explorer for people.
        segmenter: Name of the segmenter for people, and the published one that it replaces.
        model_words: Name of the chat model for people, and the published one if it is another.
        components: All components, for their optional abilities.
        files: Files that components were given, such as weights.
        ledger: Ledger of the questions to the chat model; empty without one.
        price: Price of the chat model's tokens.
        prompts: Hash of the words of every question to the chat model; empty without one.
        truth: Ground truth for stand-ins only, set by
            `hypernav.lab.episodes.episode_run.EpisodeRun`.
        detector_warning: Sentence to show before a search; empty if its scores were measured.
    """

    agent: Agent
    chosen: ChosenComponents
    detector_words: str
    reasoner_words: str
    segmenter: SegmenterWords
    model_words: str
    components: tuple[object, ...]
    files: tuple[Path, ...]
    ledger: Ledger
    price: PriceConfig
    prompts: dict[str, str]
    truth: EpisodeTruth
    detector_warning: str = ""

    def check_goal(self, goal: Goal) -> None:
        """Refuse a goal that a component can never find, a detector of fixed classes for example.

        Raises:
            GoalError: The goal can never be found; the message names the nearest classes.
        """
        for component in self.components:
            if isinstance(component, ChecksGoal):
                component.check_goal(goal)

    @property
    def warnings(self) -> list[str]:
        """Sentences to show before a search: which components are stand-ins, and the remedy."""
        told = (
            labels_warning(self.chosen),
            self.segmenter.warning,
            reasoner_warning(self.chosen),
            self.detector_warning,
            warning_of(self.agent),
        )
        return [warning for warning in told if warning]

    @property
    def looks_at_colours(self) -> bool:
        """Whether a chat model, or a component that is given images, uses their colours."""
        given_images = [
            one
            for one in self.components
            if isinstance(one, Detector | Segmenter | SceneScorer | Guide | ImageTextModel | Agent)
        ]
        return self.chosen.vlm is not None or any(map(looks_at_colours, given_images))

    def take_report(self) -> dict[str, Any]:
        """Questions and counts since the last report, for ``result.json``.

        Returns:
            Under ``ledger`` calls, tokens, seconds and retries per kind of question, and the cost
            if a price is configured; only with a chat model. Under ``fallbacks`` the components'
            counts, for example of replacements for unusable answers.
        """
        report: dict[str, Any] = {}
        if self.chosen.vlm is not None:
            report["ledger"] = self.ledger.as_dict(
                price_in_per_million=self.price.in_per_million,
                price_out_per_million=self.price.out_per_million,
            )
            self.ledger.clear()
        reporting = [one for one in self.components if isinstance(one, Reports)]
        if reporting or self.chosen.vlm is not None:
            report["fallbacks"] = {
                key: value for one in reporting for key, value in one.take_report().items()
            }
        return report

    def close(self) -> None:
        """Close all components that hold a thread, a process or a file."""
        for component in self.components:
            if isinstance(component, Closes):
                component.close()
