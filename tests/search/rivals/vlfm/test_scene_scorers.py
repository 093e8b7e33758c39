"""Scorers of views: by a model that compares, by a chat model, by the truth."""

import pytest

from chat_models import Parrot
from hypernav.core.chat import Answer
from hypernav.core.errors import LabelsMissingError, MissingExtraError, ModelError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.trace import ExchangeLog
from hypernav.search.rivals.config import TruthScorerConfig
from hypernav.search.rivals.vlfm.scene_scorers import ChatScorer, SimilarityScorer, TruthScorer
from images import thing_before_wall


class Compares:
    def __init__(self):
        self.texts = []

    def similarity(self, image, text):
        self.texts.append(text)
        return 0.25


def test_images_are_compared_with_a_sentence_about_the_goal():
    model = Compares()
    assert SimilarityScorer(model).score(thing_before_wall(), Goal("the oven")) == 0.25
    assert model.texts == ["It looks as if an oven is close by."]


def test_a_model_that_is_not_there_is_named():
    with pytest.raises((MissingExtraError, ModelError)):
        SimilarityScorer("no/such-model")


class Doubtful(Parrot):
    def ask(self, question):
        answer = super().ask(question)
        chances = {"yes": 0.3, "no": 0.7}
        return Answer(answer.text, answer.model, answer.value, probabilities=chances)


def test_the_score_is_the_probability_of_yes():
    log = ExchangeLog()
    chat = Doubtful("no")
    assert ChatScorer(chat, log).score(thing_before_wall(), Goal("oven")) == 0.3
    assert "an oven" in chat.asked[0].text
    (exchange,) = log.drain()
    assert exchange.kind == "score view"


@pytest.mark.parametrize(("says", "score"), [("yes", 1.0), ("No.", 0.0), ("perhaps", 0.5)])
def test_a_model_without_probabilities_gives_all_or_nothing(says, score):
    scorer = ChatScorer(Parrot(says), ExchangeLog())
    assert scorer.score(thing_before_wall(), Goal("oven")) == score
    assert scorer.take_report() == {"unsure_scores": int(score == 0.5)}


def truth(goal: str, label: ObjectLabel, **config) -> float:
    return TruthScorer(TruthScorerConfig(**config)).score(
        thing_before_wall(label=label), Goal(goal)
    )


def test_the_goal_in_view_scores_one():
    assert truth("bed", ObjectLabel("bed")) == 1.0


def test_a_view_of_a_kitchen_fits_an_oven_better_than_a_pillow():
    fridge, named = ObjectLabel("refrigerator"), ObjectLabel("box", room="kitchen")
    for label in (fridge, named):
        assert truth("oven", label) > 2.0 * truth("pillow", label)
    assert truth("pillow", ObjectLabel("nightstand")) > 2.0 * truth("oven", ObjectLabel("bed"))


def test_what_the_table_does_not_know_scores_alike():
    assert truth("flux capacitor", ObjectLabel("bed")) == 0.5
    assert truth("oven", ObjectLabel("gizmo")) == truth("oven", ObjectLabel("thingamajig"))


def test_errors_depend_on_view_and_goal_and_come_again():
    label, other = ObjectLabel("gizmo"), ObjectLabel("gizmo")
    first = truth("oven", label, noise=0.1)
    assert first == truth("oven", other, noise=0.1)
    assert first != truth("flux capacitor", label, noise=0.1)
    scorer = TruthScorer(TruthScorerConfig(noise=9.0))
    scores = set()
    for x in range(20):
        moved = thing_before_wall(label=label, robot=Pose2(0.1 * x, 0.0, 0.0))
        scores.add(scorer.score(moved, Goal("oven")))
    assert all(0.0 <= score <= 1.0 for score in scores)
    assert len(scores) > 2


def test_a_world_without_labels_is_refused():
    with pytest.raises(LabelsMissingError, match="similarity"):
        TruthScorer().score(thing_before_wall(with_truth=False), Goal("bed"))
