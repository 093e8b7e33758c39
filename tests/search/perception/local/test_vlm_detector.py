import json
from dataclasses import replace

import numpy as np
import pytest

from chat_models import Parrot
from hypernav.app.build.components.component_specs import PresetName
from hypernav.app.build.presets import preset
from hypernav.core.chat import Answer, Question, Usage
from hypernav.core.errors import ConfigError, ModelUnavailableError
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.config import VlmDetectorConfig
from hypernav.search.perception.local.second_look import detect_twice
from hypernav.search.perception.local.vlm_detector import VlmDetector, labels_agree
from hypernav.search.perception.local.yes_no_checks import confusions, crop_question
from images import thing_before_wall

BED = Goal("bed")
AS_THEY_ARE = VlmDetectorConfig(score_crops=0)


@pytest.fixture
def view() -> Observation:
    rgb = np.random.default_rng(0).integers(0, 255, (480, 640, 3)).astype(np.uint8)
    depth = np.ones((480, 640), np.float32)
    camera = PinholeCamera.from_hfov(640, 480, 79.0)
    return Observation(rgb, depth, camera, Transform.identity(), Pose2(0.0, 0.0, 0.0))


def said(*boxes: list[float], label: str = "bed") -> str:
    return json.dumps([{"bbox_2d": box, "label": label} for box in boxes])


def test_boxes_come_back_in_pixels_of_the_camera_image(view: Observation):
    parrot, log = Parrot(said([322, 238, 644, 476], [0, 0, 161, 119])), ExchangeLog()
    first, second = VlmDetector(parrot, log, AS_THEY_ARE).detect(view, BED)
    assert (first.box.x_min, first.box.y_max) == pytest.approx((320.0, 480.0))
    assert (second.box.x_max, second.box.y_max) == pytest.approx((160.0, 120.0))
    assert (first.label, first.score) == ("bed", 1.0)
    (question,) = parrot.asked
    assert question.images[0].shape == (476, 644, 3)
    assert "every bed" in question.text
    assert '"bbox_2d"' in question.text


def test_the_exchange_is_logged_word_for_word(view: Observation):
    text = said([0, 0, 161, 119])
    log = ExchangeLog()
    VlmDetector(Parrot(text), log, AS_THEY_ARE).detect(view, BED)
    (exchange,) = log.drain()
    assert (exchange.kind, exchange.asked, exchange.answer) == ("ground", "parrot/Qwen2.5-VL", text)
    assert (exchange.tokens_in, exchange.tokens_out) == (100, len(text))
    assert exchange.remarks == []


def test_a_weak_box_is_no_reason_to_ask_about_the_same_image_again(view: Observation):
    parrot = Parrot('{"bbox_2d": [322, 238, 400, 300], "label": "bed", "score": 0.4}')
    detector = VlmDetector(parrot, ExchangeLog(), AS_THEY_ARE)
    (found,) = detect_twice(detector, view, BED, below=0.5)
    assert (found.score, len(parrot.asked)) == (0.4, 1)


@pytest.mark.parametrize("text", ["[]", "```json\n[]\n```", '{"objects": []}'])
def test_not_seen_is_no_oddity(view: Observation, text: str):
    log = ExchangeLog()
    detector = VlmDetector(Parrot(text), log)
    assert detector.detect(view, BED) == []
    assert log.drain()[0].remarks == []
    assert not detector.rejected


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        ("There is a bed on the left.", "no box in the answer"),
        ("", "unparsable"),
        (said([9, 9, 1]), "1 box not four numbers"),
        (said([9, 9, 1, 1], [9, 9, 2, 2]), "2 boxes inverted"),
    ],
)
def test_what_cannot_be_used_is_counted_and_told(view: Observation, text: str, remark: str):
    log = ExchangeLog()
    detector = VlmDetector(Parrot(text), log)
    assert detector.detect(view, BED) == []
    assert log.drain()[0].remarks == [remark]
    assert sum(detector.rejected.values()) >= 1


def test_another_label_is_visible_and_counted(view: Observation):
    text = said([0, 0, 161, 119], label="window curtain")
    goal = Goal("shower curtain")
    log = ExchangeLog()
    detector = VlmDetector(Parrot(text), log)
    (seen,) = detector.detect(view, goal)
    assert seen.label == "window curtain"
    assert detector.rejected == {"other label": 1}
    assert log.drain()[0].remarks == ["labelled 'window curtain', not 'shower curtain'"]


@pytest.mark.parametrize(
    ("label", "goal", "agree"),
    [
        ("bed", "bed", True),
        ("The Bed", "bed", True),
        ("couch", "sofa", True),
        ("L-shaped sofa", "sofa", True),
        ("sofa", "L-shaped sofa", True),
        ("window curtain", "shower curtain", False),
        ("table", "bed", False),
        ("couch", "The couch is located near the window.", True),
        ("window", "The couch is located near the window.", False),
        ("chair", "the chair beside the desk", True),
        ("desk", "the chair beside the desk", False),
        ("pillow on the bed", "bed", False),
        ("not a bed", "bed", False),
        ("bed not visible", "bed", False),
        ("non-bed", "bed", False),
        ("none", "bed", False),
        ("\x1b[31m\x00", "bed", False),
        (" ", "bed", False),
        ("bed " * 5000, "bed", True),
        ("no smoking sign", "no smoking sign", True),
        ("no parking sign", "the no parking sign", True),
    ],
)
def test_labels(label: str, goal: str, agree: bool):
    assert labels_agree(label, Goal(goal)) is agree


def test_the_family_is_configured_or_read_off_the_name_but_never_guessed(view: Observation):
    class Stranger(Parrot):
        def identify(self) -> str:
            return "my-finetune"

    text = said([500, 500, 1000, 1000])
    with pytest.raises(ConfigError, match="name its family"):
        VlmDetector(Stranger(text), ExchangeLog()).detect(view, BED)
    config = VlmDetectorConfig(family="qwen3-vl")
    (seen,) = VlmDetector(Stranger(text), ExchangeLog(), config).detect(view, BED)
    assert (seen.box.x_min, seen.box.y_min) == (320.0, 240.0)


def test_a_constrained_answer_is_read_as_well(view: Observation):
    text = json.dumps({"objects": [{"bbox_2d": [0, 0, 161, 119], "label": "bed"}]})
    parrot = Parrot(text)
    detector = VlmDetector(parrot, ExchangeLog(), VlmDetectorConfig(constrained=True))
    assert len(detector.detect(view, BED)) == 1
    form = parrot.asked[0].form
    assert form is not None
    assert form.model_json_schema()["additionalProperties"] is False


def test_an_outage_is_not_taken_for_an_empty_room(view: Observation):
    with pytest.raises(ModelUnavailableError):
        VlmDetector(Parrot(ModelUnavailableError("gone")), ExchangeLog()).detect(view, BED)


def test_a_prompt_that_cannot_be_filled_in_is_refused():
    with pytest.raises(ValueError, match="may hold"):
        VlmDetectorConfig(prompt="Find {target}")


def test_a_goal_with_braces_is_only_text(view: Observation):
    parrot = Parrot("[]")
    VlmDetector(parrot, ExchangeLog()).detect(view, Goal("{key} {0}"))
    assert "every {key} {0} in" in parrot.asked[0].text


class Certain(Parrot):
    """Says where beds are, and how likely each crop is one."""

    def __init__(self, boxes: str, *yes: float) -> None:
        super().__init__(boxes)
        self.yes = list(yes)

    def ask(self, question: Question) -> Answer:
        if question.kind != "crop":
            return super().ask(question)
        self.asked.append(question)
        yes = self.yes.pop(0)
        said = "yes" if yes > 0.5 else "no"
        return Answer(said, "m", value=said, probabilities={"yes": yes, "no": 1.0 - yes})


def test_the_probability_of_a_crop_is_the_score_of_its_box(view: Observation):
    model = Certain(said([0, 0, 161, 119], [322, 238, 644, 476]), 0.8, 0.4)
    log = ExchangeLog()
    small, large = VlmDetector(model, log).detect(view, BED)
    assert (large.score, small.score) == (0.8, 0.4)
    _, of_large, of_small = model.asked
    assert of_large.allowed == ("yes", "no")
    assert of_large.images[0].shape[0] > of_small.images[0].shape[0] > 120
    assert [exchange.kind for exchange in log.drain()] == ["ground", "crop", "crop"]


def test_what_is_denied_on_a_closer_look_is_no_detection(view: Observation):
    detector = VlmDetector(Certain(said([0, 0, 161, 119]), 0.1), ExchangeLog())
    assert detector.detect(view, BED) == []
    assert detector.rejected == {"denied on a closer look": 1}


@pytest.mark.parametrize(("text", "score"), [("yes", 1.0), ("perhaps", 0.5)])
def test_without_probabilities_the_word_counts_and_doubt_is_doubt(
    view: Observation, text: str, score: float
):
    (one,) = VlmDetector(Parrot(said([0, 0, 161, 119]), text), ExchangeLog()).detect(view, BED)
    assert one.score == score


def test_no_more_crops_than_configured_are_asked_about(view: Observation):
    model = Certain(said([0, 0, 161, 119], [322, 238, 644, 476], [0, 238, 161, 476]), 0.9)
    config = VlmDetectorConfig(score_crops=1)
    found = VlmDetector(model, ExchangeLog(), config).detect(view, BED)
    assert [one.score for one in found] == [1.0, 0.9, 1.0]


def test_likely_confusions_are_offered_as_alternatives(view: Observation):
    question = crop_question(view.rgb, Goal("the shower curtain"))
    assert "a shower curtain, a window curtain or something else?" in question.text
    assert confusions(Goal("umbrella")) == ()
    assert set(confusions(Goal("couch"))) == {"armchair", "bed"}


@pytest.mark.parametrize("name", ["paper", "default"])
def test_goals_are_asked_for_without_their_article(view: Observation, name: PresetName):
    model = Parrot("[]")
    config = preset(name).grounding
    VlmDetector(model, ExchangeLog(), config).detect(view, Goal("the chair in the office"))
    assert "Locate every chair in the office in the picture" in model.asked[0].text
    assert "no chair in the office in" in model.asked[0].text


@pytest.mark.parametrize(
    "text",
    [
        '{"image_size": [0, 0, 640, 480], "objects": []}',
        '[{"bbox_2d": [100, 100, 300, 300], "label": "not a bed"}]',
        '[{"bbox_2d": [100, 100, 300, 300], "label": "bed", "visible": false}]',
        '{"bed": [], "rejected": [{"bbox_2d": [100, 100, 300, 300]}]}',
    ],
)
def test_numbers_that_are_no_box_of_the_goal_are_told_and_no_detection(
    view: Observation, text: str
):
    log = ExchangeLog()
    assert VlmDetector(Parrot(text), log).detect(view, BED) == []
    (exchange,) = log.drain()
    assert exchange.remarks


def test_a_key_that_names_the_goal_holds_its_box(view: Observation):
    (one,) = VlmDetector(Parrot('{"couch": [100, 100, 300, 300]}'), ExchangeLog()).detect(
        view, Goal("sofa")
    )
    assert one.label == "couch"


def test_boxes_that_were_only_thought_about_are_none(view: Observation):
    log = ExchangeLog()
    text = "…[100,200,300,400] is no bed</think> []"
    assert VlmDetector(Parrot(text), log, AS_THEY_ARE).detect(view, BED) == []
    assert log.drain()[0].remarks == []


def test_a_reply_cut_in_its_thinking_is_told_with_the_remedy(view: Observation):
    log = ExchangeLog()
    detector = VlmDetector(Parrot("<think>[100, 200, 300, 400] is a bed"), log, AS_THEY_ARE)
    assert detector.detect(view, BED) == []
    (exchange,) = log.drain()
    assert exchange.fault == "cut while thinking"
    assert "--set chat.thinking=off" in exchange.remarks[0]
    assert detector.rejected == {"cut while thinking": 1}


def test_a_point_becomes_the_box_of_what_depth_connects_with_it():
    seen = thing_before_wall()  # the thing fills (60, 40, 100, 80) of 160 by 120 pixels
    parrot = Parrot('<point x="50" y="50" alt="bed">bed</point>')
    config = VlmDetectorConfig(family="molmo", score_crops=0)
    (found,) = VlmDetector(parrot, ExchangeLog(), config).detect(seen, BED)
    assert (found.box, found.point) == (Box(60.0, 40.0, 100.0, 80.0), (80.0, 60.0))
    assert (found.label, found.score) == ("bed", 1.0)
    assert parrot.asked[0].text.startswith("Point to every bed")


def test_a_point_without_depth_has_a_small_box_around_it():
    seen = thing_before_wall(thing_m=0.0)
    config = VlmDetectorConfig(family="molmo", score_crops=0)
    parrot = Parrot('<point x="50" y="50" alt="bed">bed</point>')
    (found,) = VlmDetector(parrot, ExchangeLog(), config).detect(seen, BED)
    assert found.box == Box(72.0, 52.0, 88.0, 68.0)


def test_ones_own_words_go_before_a_familys(view: Observation):
    for prompt, begin in ((None, "detect bed"), ("Find the {goal}!", "Find the bed!")):
        parrot = Parrot("")
        config = VlmDetectorConfig(family="paligemma", score_crops=0)
        config = config if prompt is None else config.model_copy(update={"prompt": prompt})
        VlmDetector(parrot, ExchangeLog(), config).detect(view, BED)
        assert parrot.asked[0].text == begin


class Enlarging(Parrot):
    """llama.cpp with ``--image-min-tokens 1024`` and a system prompt: what it sees, it counts."""

    def __init__(self, text: str, image_tokens: int, words: int = 80) -> None:
        super().__init__(text)
        self.image_tokens, self.words = image_tokens, words

    def ask(self, question: Question) -> Answer:
        shown = self.image_tokens + 2 if question.images else 0
        usage = Usage(self.words + shown, 5)
        return replace(super().ask(question), usage=usage)


@pytest.mark.parametrize(
    ("tokens", "words", "sent", "asked"),
    [
        (391, 80, (644, 476), 1),
        (1064, 80, (1064, 784), 2),  # as llama.cpp was seen to count, 644x476 sent
        (391, 2000, (644, 476), 2),  # many words, and no larger image
    ],
)
def test_boxes_are_read_at_the_size_that_a_server_enlarges_images_to(
    view: Observation, tokens: int, words: int, sent: tuple[int, int], asked: int
):
    half = [0.0, 0.0, sent[0] / 2, sent[1] / 2]
    parrot = Enlarging(said(half), tokens, words)
    detector = VlmDetector(parrot, ExchangeLog(), AS_THEY_ARE)
    boxes = [one.box for one in detector.detect(view, BED)]
    assert len(parrot.asked) == asked
    assert [one.box for one in detector.detect(view, BED)] == boxes == [Box(0, 0, 320, 240)]
    assert len(parrot.asked) == asked + 1
    assert parrot.asked[-1].images[0].shape[:2] == (sent[1], sent[0])
