import math

import pytest

from hypernav.app.show import captions
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.core.trace import DetectionRecord, Exchange, Mode, StepTrace
from hypernav.search.drawing import palette


def test_the_gist_of_a_long_prompt_is_its_question() -> None:
    prompt = "You help a robot. Is this clear? White is free floor. " * 8
    assert (
        captions.final_question(prompt + "Which block is next? Answer a number.")
        == "Which block is next?"
    )
    assert (
        captions.final_question("Which block?\n  Answer a number.")
        == "Which block? Answer a number."
    )
    unasked = "Say where to go. " * 30
    assert captions.final_question(unasked) == unasked.strip()


@pytest.mark.parametrize(
    ("result", "text", "tone"),
    [
        ({"goal": "bed", "outcome": "found", "success": True}, "Found “bed”", "good"),
        ({"goal": "bed", "outcome": "found"}, "Found “bed”", "good"),
        ({"goal": "bed", "outcome": "found", "success": False}, "not at “bed”", "bad"),
        ({"goal": "bed", "outcome": "wrong_place", "success": False}, "not at “bed”", "bad"),
        ({"goal": "bed", "outcome": "not_found", "success": False}, "Did not find “bed”", "bad"),
        ({"goal": "bed", "outcome": "model_unavailable"}, "model did not answer", "neutral"),
        ({"goal": "bed", "outcome": "interrupted"}, "Interrupted", "neutral"),
        ({"goal": "bed", "outcome": "out_of_battery"}, "out of battery", "bad"),
        ({"goal": "{goal} {0}", "outcome": "not_found"}, "“{goal} {0}”", "bad"),
        ({}, "unknown", "bad"),
    ],
)
def test_every_ending_has_a_headline(result: dict[str, object], text: str, tone: str) -> None:
    headline = captions.headline(result)
    assert text in headline.text
    assert headline.tone == tone


def test_a_search_that_found_nothing_says_how_it_ended() -> None:
    ended = {"goal": "bed", "outcome": "not_found", "steps": 500}
    assert "not where the robot looked" in captions.headline(ended).detail
    out_of_steps = captions.headline({**ended, "max_steps": 500, "distance_to_goal_m": 3.21})
    assert out_of_steps.detail == (
        "It was still looking when all 500 steps were used. "
        f"It ended {captions.number(3.21, 1, 'm')} of path from the nearest one."
    )
    assert "Nothing in the building" not in out_of_steps.detail
    absent = captions.headline({**ended, "holds_goal": False})
    assert absent.detail == "Nothing in the building answers to it."
    stuck = captions.headline({**ended, "holds_goal": False, "detail": "nowhere to go"})
    assert stuck.detail == f"{absent.detail} Why it ended: nowhere to go"
    far = captions.headline({**ended, "max_steps": 600, "distance_to_goal_m": math.inf})
    assert far.detail == captions.headline(ended).detail


def test_ground_truth_is_called_by_its_name_however_it_is_spelt() -> None:
    for name in ("ground truth", "ground-truth", "Ground_Truth"):
        assert captions.is_ground_truth(name)
        assert "ground truth labels" in captions.component_caption(name)
        assert "no model" in captions.component_caption(name)
    assert captions.is_ground_truth("ground-truth labels of the simulator")
    assert "no model" in captions.component_caption("geometric")
    assert not captions.is_ground_truth("yolox:ground.onnx")
    assert captions.component_caption("yolox:nano.onnx") == "yolox:nano.onnx"


def test_numbers_that_are_missing_or_endless_can_be_read() -> None:
    assert captions.number(None) == "–"
    assert captions.number("7") == "–"
    assert captions.number(math.nan) == "–"
    assert captions.number(math.inf, unit="m") == "∞"
    assert captions.number(True) == "yes"
    assert captions.number(7) == "7"
    assert captions.number(1.236, 2, "m") == "1.24\u00a0m"


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0.0 ms"),
        (0.0021, "2.1 ms"),
        (0.4104, "410 ms"),
        (0.9996, "1.0 s"),
        (59.97, "1 min 0 s"),
        (125.2, "2 min 5 s"),
    ],
)
def test_durations_have_the_unit_that_fits(seconds: float, text: str) -> None:
    assert captions.duration(seconds) == text


def test_what_is_seen_is_said_of_the_best_detection(sighting: DetectionRecord) -> None:
    far = sighting.model_copy(update={"accepted": False, "reason": "too far", "score": 0.99})
    assert captions.detections_caption([]) == "goal not in view"
    assert captions.detections_caption([far]) == "“bed” not accepted: too far"
    assert captions.detections_caption([far, sighting]) == "sees “bed”, 83% sure"


def test_who_asks_to_stop_says_what_was_answered_and_nothing_of_detections() -> None:
    asked = Exchange(kind="stop", asked="truth", question="Is it near?", answer="no: 2.0 m away")
    step = StepTrace(
        step=0, pose=(0.0, 0.0, 0.0), action=None, mode=Mode.EXPLORE, exchanges=[asked]
    )
    assert captions.camera_caption(step) == "is the goal right here? “no: 2.0 m away”"
    assert not EpisodeInfo("bed", "pivot (native)", captions.ITS_OWN).has_detector
    assert EpisodeInfo("bed", "pivot", "ground truth").has_detector


def test_credits_name_no_part_that_an_agent_does_not_have() -> None:
    assert EpisodeInfo("bed", "mine", captions.ITS_OWN, captions.ITS_OWN).credits == "mine"
    native = EpisodeInfo("bed", "pivot (native)", captions.ITS_OWN, "model").credits
    assert native.startswith("pivot (native)")
    assert "sees with" not in native
    assert "decides with model" in native


def test_an_unknown_kind_of_question_keeps_its_name() -> None:
    exchange = Exchange(kind="ask a person", asked="", question="", answer="")
    assert captions.question_caption(exchange) == "Ask a person"


def test_every_mode_has_words_and_a_colour_that_its_ink_can_be_read_on() -> None:
    for mode in Mode:
        assert captions.MODES[mode]
        assert captions.MODES_EXPLAINED[mode]
        color = palette.MODES[mode]
        assert palette.contrast(palette.ink_on(color), color) >= 4.5


def test_colours_of_text_can_be_read_on_their_ground() -> None:
    for ink in (palette.INK, palette.MUTED, palette.SUCCESS, palette.FAILURE):
        for ground in (palette.PAPER, palette.GROUND):
            assert palette.contrast(ink, ground) >= 3.9, (ink, ground)


def test_black_on_white_has_the_greatest_contrast() -> None:
    assert palette.contrast((0, 0, 0), (255, 255, 255)) == pytest.approx(21.0)
    assert palette.blend((0, 0, 0), (255, 255, 255), 0.5) == (128, 128, 128)
    assert palette.css((0, 96, 160)) == "#0060a0"


def test_the_two_parts_of_a_path_in_a_sentence():
    walked = {"shortest_path_m": 5.0, "explored_m": 9.5, "approached_m": 3.6}
    assert captions.path_parts(walked | {"shortest_from_sight_m": 3.0}).replace("\u00a0", " ") == (
        " It walked 9.5 m (1.9 times the shortest path) before it saw the goal, and 3.6 m "
        "(1.2 times the shortest path) from there."
    )
    at_once = walked | {"explored_m": 0.0, "shortest_from_sight_m": None}
    assert captions.path_parts(at_once).replace("\u00a0", " ") == (
        " It saw the goal from where it started, and walked 3.6 m from there."
    )
    assert captions.path_parts({"shortest_path_m": 5.0}) == ""


@pytest.mark.parametrize(
    ("mode", "floor", "words"),
    [
        (Mode.EXPLORE, None, ""),
        (Mode.EXPLORE, 2, "floor 2 · "),
        (Mode.CLIMB, None, "stairs from floor 1 · "),
        (Mode.CLIMB, 2, "stairs from floor 2 · "),
    ],
)
def test_a_floor_is_named_once_there_are_others_and_stairs_by_theirs(
    mode: Mode, floor: int | None, words: str
) -> None:
    step = StepTrace(step=0, pose=(0.0, 0.0, 0.0), action=None, mode=mode, floor=floor)
    assert captions.floor_prefix(step) == words
