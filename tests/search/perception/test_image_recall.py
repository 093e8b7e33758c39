"""The question about remembered images: what is sent, and what its answers mean."""

import numpy as np
import pytest

from chat_models import Parrot, image
from hypernav.core.errors import ModelUnavailableError
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.config import ImageRecallConfig
from hypernav.search.perception.image_recall import ImageRecall, images_question, named_images

IMAGES = [image(k) for k in range(5)]


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("2, 5", (2, 5)),
        ("5 and 2.", (2, 5)),
        ("[3]", (3,)),
        ("Image 4", (4,)),
        ("<think>1 shows a cup, not the umbrella</think>3", (3,)),
        ("It stands in the corner of the third room.\nAnswer: 2, 3", (2, 3)),
        ("1, 2\nThe others do not show it.", (1, 2)),
        ("3, 9", (3,)),
        ("I see 1 bed in image 4", (4,)),
        ("There are 6 images; it is in image 3", (3,)),
        ("Image 3 of 6 shows 2 of them, and image number 5 too.", (3, 5)),
        ("In 2 images: 1, and 3.", (1, 3)),
        ("**Images 2 and 5**", (2, 5)),
        ("In images 1 to 3", (1, 2, 3)),
        ("Images 1–2 and 4", (1, 2, 4)),
        ("1-3", (1, 2, 3)),
        ("1 to 3, 5", (1, 2, 3, 5)),
        ("4-999999", (4, 5)),
        ("5-1", (1, 5)),
        ("No. 3", (3,)),
        ("image no. 3", (3,)),
        ("No. 3 chairs and a table", None),
        ("No, image 3 doesn't show it", None),
        ("2 of them in image 9", None),
        ("none", ()),
        ("None of the images shows an umbrella.", ()),
        ("There isn't any.", ()),
        ("[]", ()),
        ("0", ()),
        ("Answer: none", ()),
        ("9", None),
        ("Image 1 does not show it, image 2 may", None),
        ("a nice house", None),
        ("0.5", None),
        ("", None),
    ],
)
def test_an_answer_names_images_or_none_or_cannot_be_read(text, named):
    assert named_images(text, 5) == named


def test_one_sheet_shows_all_images_with_their_numbers_and_the_words_name_the_goal():
    question = images_question(ImageRecallConfig(), IMAGES, Goal("umbrella"))
    (sheet,) = question.images
    assert sheet.shape == (2 * 480 + 8, 3 * 640 + 2 * 8, 3)
    assert (sheet[600:, 1400:] == 255).all()  # there is no sixth image
    assert "do you see an umbrella?" in question.text
    middle = [images_question(ImageRecallConfig(), [one], Goal("cup")).images[0] for one in IMAGES]
    assert all(one.shape == (480, 640, 3) for one in middle)
    assert not np.array_equal(sheet[:80, :80], sheet[:80, 648:728])


def test_images_of_different_shapes_share_a_sheet():
    tall = images_question(ImageRecallConfig(), [image(0, 64, 32), image(1)], Goal("cup"))
    assert tall.images[0].shape == (1280, 1288, 3)


def test_answers_are_kept_for_the_trace_and_unusable_ones_counted():
    log = ExchangeLog()
    recall = ImageRecall(Parrot("2, 4", "who knows", "none"), log)
    told = [recall.shown_in(IMAGES, Goal("cup")) for _ in range(3)]
    assert told == [(1, 3), (), ()]
    exchanges = log.drain()
    assert [one.kind for one in exchanges] == ["choose images"] * 3
    assert [one.remarks for one in exchanges] == [[], ["it names no image"], []]
    assert recall.take_report() == {"unread_image_answers": 1}
    assert recall.take_report() == {}


def test_a_model_that_is_away_is_an_error():
    recall = ImageRecall(Parrot(ModelUnavailableError("gone")), ExchangeLog())
    with pytest.raises(ModelUnavailableError):
        recall.shown_in(IMAGES, Goal("cup"))
