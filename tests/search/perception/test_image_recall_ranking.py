"""The ranking of remembered images: by a model that knows colours."""

import gc
from collections.abc import Sequence

import numpy as np
import pytest

from hypernav.core.errors import ContractError, ModelError
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.memory.key_images import KeyImage
from hypernav.search.perception.image_recall import ImageRanking
from images import key_image

GREY, RED = (90, 90, 90), (250, 10, 10)
COLOURS = ("red", "green", "blue")


class KnowsColours:
    """Its vectors: how red, green and blue an image is, and how bright; brightness fits any text.

    It looks at the halves of an image by themselves.
    """

    def __init__(self, *, sizes: tuple[int, int] = (4, 4)) -> None:
        self.seen: list[np.ndarray] = []
        self.sizes = sizes

    def image_vectors(self, image: np.ndarray) -> np.ndarray:
        self.seen.append(image)
        halves = np.array([half.reshape(-1, 3).mean(0) for half in np.array_split(image, 2, 1)])
        return np.column_stack([halves, np.full(2, 100.0)])[:, : self.sizes[0]].astype(np.float32)

    def text_vectors(self, texts: Sequence[str]) -> np.ndarray:
        named = [[2.0 * (colour in text) for colour in COLOURS] + [1.0] for text in texts]
        return np.array(named, np.float32)[:, : self.sizes[1]]


def taken(number: int, left: tuple[int, int, int], right: tuple[int, int, int] | None = None):
    """A key image, of one colour or of two side by side."""
    rgb = np.empty((24, 32, 3), np.uint8)
    rgb[:, :16], rgb[:, 16:] = left, right or left
    return key_image(number, rgb)


def ranking(model: KnowsColours | None = None) -> ImageRanking:
    return ImageRanking(model or KnowsColours(), ExchangeLog(), "similarity by colours", 3.0)


def greys(count: int) -> list[KeyImage]:
    return [taken(k, (85 + k % 5, 88, 90)) for k in range(count)]


def test_the_image_that_looks_like_the_goal_stands_out_and_no_other_does():
    first, *others = ranking().ranked([*greys(10), taken(10, RED)], Goal("red ball"))
    assert first.number == 10
    assert first.above > 3.0
    assert all(one.above < 3.0 for one in others)
    assert [one.above for one in others] == sorted((one.above for one in others), reverse=True)


def test_images_stand_out_from_the_middle_one_in_deviations_of_a_normal_spread():
    ranked = ranking().ranked(
        [taken(k, (100 + k * k, 90, 90)) for k in range(11)], Goal("red ball")
    )
    above = [one.above for one in ranked]
    assert ranked[0].number == 10
    assert float(np.median(above)) == 0.0
    assert float(np.median(np.abs(above))) == pytest.approx(0.6745, abs=0.001)  # of a normal one


def test_a_small_part_of_an_image_is_enough():
    first, *_ = ranking().ranked([*greys(10), taken(10, GREY, RED)], Goal("red ball"))
    assert (first.number, first.above > 3.0) == (10, True)


def test_an_image_that_fits_any_words_is_not_taken_for_the_goal():
    """A black image is nothing but what fits any words: its bare similarity is the greatest."""
    model, words = KnowsColours(), "a photo of a gizmo"
    images = [*greys(10), taken(10, (0, 0, 0))]
    bare = [max(v[3] / np.linalg.norm(v) for v in model.image_vectors(one.rgb)) for one in images]
    assert int(np.argmax(bare)) == 10
    assert model.text_vectors([words])[0].tolist() == [0.0, 0.0, 0.0, 1.0]
    assert [one.above for one in ranking().ranked(images, Goal("gizmo"))] == [0.0] * 11


@pytest.mark.parametrize("goal", ["red ball", "gizmo"])
def test_nothing_stands_out_of_images_that_look_alike(goal):
    ranked = ranking().ranked(greys(30), Goal(goal))
    assert {one.number for one in ranked} == set(range(30))
    assert all(one.above < 3.0 for one in ranked)


def test_too_few_images_are_ranked_but_none_stands_out():
    ranked = ranking().ranked([*greys(3), taken(3, RED)], Goal("red ball"))
    assert [one.above for one in ranked] == [0.0] * 4
    assert ranked[0].number == 3


def test_the_order_of_the_images_is_no_matter():
    images = [*greys(10), taken(10, RED), taken(11, (160, 60, 60))]
    forwards, backwards = (ranking().ranked(one, Goal("red")) for one in (images, images[::-1]))
    assert forwards == backwards


def test_every_image_is_given_to_the_model_once_and_let_go_when_it_is_forgotten():
    model = KnowsColours()
    images, rank = greys(9), ranking(model)
    for goal in ("red ball", "green ball"):
        rank.ranked(images, Goal(goal))
    assert len(model.seen) == 9
    rank.ranked([*images, taken(9, RED)], Goal("red ball"))
    assert len(model.seen) == 10
    gc.collect()
    assert len(rank.known) == 9  # nobody else holds the tenth
    del images[4:]
    gc.collect()
    assert len(rank.known) == 4


def test_a_ranking_is_told_in_the_trace_and_an_empty_memory_asks_nothing():
    model = KnowsColours()
    rank = ranking(model)
    assert rank.ranked([], Goal("red ball")) == []
    assert not model.seen
    assert rank.log.drain() == []
    rank.ranked([*greys(10), taken(10, RED)], Goal("a red ball"))
    (told,) = rank.log.drain()
    assert (told.kind, told.asked, told.by_model) == ("rank images", "similarity by colours", False)
    assert told.question == "a photo of a red ball"
    assert told.answer.startswith("image 10: +")
    assert told.seconds > 0.0


def test_a_model_that_can_not_be_used_is_refused_before_the_search():
    class Broken(KnowsColours):
        def text_vectors(self, texts: Sequence[str]) -> np.ndarray:
            raise ModelError("no vectors")

    with pytest.raises(ModelError, match="no vectors"):
        ranking(Broken())


def test_vectors_that_can_not_be_compared_name_the_model():
    with pytest.raises(ContractError, match=r"similarity by colours: .* 3 numbers, .* texts 4"):
        ranking(KnowsColours(sizes=(3, 4))).ranked(greys(1), Goal("red ball"))
