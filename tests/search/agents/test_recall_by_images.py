"""Searches for what no detector named, and a key image shows."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import pytest

from chat_models import Parrot
from hypernav.app.build.agents import build_agent, build_search
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.core.chat import Question
from hypernav.core.components.door import through_door
from hypernav.core.components.protocols import ImageTextModel
from hypernav.core.episode import Outcome
from hypernav.core.errors import ComponentError, ModelUnavailableError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.agents.search import SearchAgent
from hypernav.search.memory.key_images import KeyImage, KeyImages
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.config import ImageRecallConfig
from hypernav.search.perception.exchanges import prompt_hash
from hypernav.search.perception.image_recall import NEUTRAL_WORDS, ImageRanking, ImageRecall
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

CONFIG = small_config()
START = Pose2(2.5, 1.0, 1.5)
IN_BEDROOM = Pose2(6.0, 3.0, 0.0)
SOFA = (0.5, 2.0, 0.3)
TOLD = "the sofa is in an image that was taken there before"


class GoalsOnly:
    """Detects the goal, and names nothing else: the things of a memory are none."""

    def detect(self, observation, goal):
        return GroundTruthDetector().detect(observation, goal)


def searched(goal, start, memory, *says, config=None, similar=None, **search):
    """The steps of a search with a model that says so of the images, its result and questions.

    `similar` is a model that compares images with texts; without it no model does.
    """
    log, chat = ExchangeLog(), Parrot(*says)
    agent = build_search(
        small_config(search=search),
        GoalsOnly(),
        log,
        image_recall=ImageRecall(chat, log, config or ImageRecallConfig()) if says else None,
        image_ranking=ImageRanking(similar, log, "colours", 3.0) if similar else None,
    )
    world = two_rooms()
    world.keep_map_frame(START.to_transform())
    try:
        run = EpisodeRun(agent, world, episode_from(start, goal, max_steps=200), memory=memory)
        steps = [step.trace for step in run]
    finally:
        world.keep_map_frame(None)
    return steps, run.result(), chat.asked


@pytest.fixture(scope="module")
def explored() -> Memory:
    """What a robot knows that has explored both rooms in vain, with key images and no things."""
    memory = Memory(CONFIG.mapping, CONFIG.embodiment, images=KeyImages(50_000_000))
    searched("piano", START, memory)
    assert memory.floor.things.known == ()
    return memory


@pytest.fixture
def memory(explored) -> Memory:
    """A copy of it."""
    return explored.copy()


def shows_sofa(image: KeyImage) -> bool:
    """Whether the sofa is in front of the camera, near, and in the same room."""
    point = np.array([SOFA]) - [START.x, START.y, 0.0]
    turn = np.array(
        [[np.cos(START.yaw), np.sin(START.yaw)], [-np.sin(START.yaw), np.cos(START.yaw)]]
    )
    x, y = turn @ point[0, :2]
    in_room = START.to_transform().apply(np.array([[*image.robot.xy, 0.0]]))[0, 0] < 5.0
    return (
        in_room
        and image.robot.distance_to(x, y) < 3.5
        and abs(np.degrees(image.robot.bearing_to(x, y))) < 25.0
    )


def images_of(memory: Memory) -> KeyImages:
    assert memory.images is not None
    return memory.images


def truthfully(memory: Memory) -> Callable[[Question], str]:
    """The answers of a model that sees the sofa wherever it is, question after question."""
    images = images_of(memory)
    left = list(images.most_telling(0, before=2, most=1000))
    shows = {one.number for one in images.kept if shows_sofa(one)}

    def says(question: Question) -> str:
        group, left[:] = left[:6], left[6:]
        numbers = [k + 1 for k, n in enumerate(group) if n in shows]
        return ", ".join(map(str, numbers)) or "none"

    return says


def kinds(steps) -> list[str]:
    return [one.kind for step in steps for one in step.exchanges]


def test_the_robot_goes_straight_to_what_only_a_key_image_shows(memory):
    steps, result, asked = searched("sofa", IN_BEDROOM, memory, truthfully(memory))
    _, without, _ = searched("sofa", IN_BEDROOM, memory.copy())
    assert steps[0].reason == TOLD
    assert result.metrics.success
    assert result.metrics.spl > 0.8
    assert result.steps <= without.steps
    assert all(question.kind == "choose images" for question in asked)
    assert kinds(steps[:1]) == ["choose images"] * len(asked)
    assert not any(kinds(steps[1:]))  # asked once, and not again on the way


def test_images_in_which_nothing_is_now_go_out_and_the_search_goes_on(memory):
    steps, result, asked = searched("sofa", IN_BEDROOM, memory, "1")
    assert steps[0].reason == TOLD
    assert result.metrics.success
    assert len(asked) <= ImageRecallConfig().max_questions


def test_a_model_that_always_says_1_costs_no_more_places_than_questions(memory):
    config = ImageRecallConfig(max_questions=2)
    steps, result, asked = searched("piano", IN_BEDROOM, memory, "1", config=config)
    images = min(2 * 6, len(images_of(memory).kept))
    assert len(asked) == -(-images // 6)
    told = TOLD.replace("sofa", "piano")
    left = [a.reason == told and b.reason != told for a, b in pairwise(steps)]
    assert 1 <= sum(left) <= len(asked)
    assert steps[-1].reason == "nothing is left to explore"
    assert result.metrics.success is False


@pytest.mark.parametrize("says", ["none", "what a nice house"])
def test_an_answer_that_names_no_image_leaves_the_search_as_it_is_without_a_model(memory, says):
    asked_steps, _, asked = searched("sofa", IN_BEDROOM, memory.copy(), says)
    steps, _, _ = searched("sofa", IN_BEDROOM, memory)
    assert asked
    assert [one.action for one in asked_steps] == [one.action for one in steps]
    assert [one.reason for one in asked_steps] == [one.reason for one in steps]


def test_a_model_that_is_away_ends_the_search_as_in_every_question(memory):
    _, result, _ = searched("sofa", IN_BEDROOM, memory, ModelUnavailableError("gone"))
    assert result.outcome is Outcome.MODEL_UNAVAILABLE


@pytest.mark.parametrize("off", ["recall", "questions", "images", "memory"])
def test_nothing_is_asked_without_memory_images_or_leave_to(memory, off):
    if off == "images":
        memory.images = None
    steps, _, asked = searched(
        "sofa",
        IN_BEDROOM,
        None if off == "memory" else memory,
        "1",
        config=ImageRecallConfig(max_questions=0 if off == "questions" else 4),
        recall=off != "recall",
    )
    assert not asked
    assert not any(step.reason == TOLD for step in steps)


def test_a_remembered_thing_is_gone_to_without_a_question(memory):
    log, chat = ExchangeLog(), Parrot("1")
    agent = build_search(CONFIG, GroundTruthDetector(), log, image_recall=ImageRecall(chat, log))
    world = two_rooms()
    world.keep_map_frame(START.to_transform())
    try:
        known = agent.new_memory()
        known.images = KeyImages(50_000_000)
        for goal, start in (("piano", START), ("sofa", IN_BEDROOM)):
            chat.asked.clear()
            for _ in EpisodeRun(agent, world, episode_from(start, goal), memory=known):
                pass
    finally:
        world.keep_map_frame(None)
    assert known.floor.things.fitting(Goal("sofa"))
    assert not chat.asked


def test_an_agent_with_a_chat_model_asks_it_by_the_configured_words():
    config = small_config(image_recall={"prompt": "Where is a {goal}?"})
    parts = build_agent(config, ComponentSpecs(vlm="openai:http://127.0.0.1:9/v1#qwen3-vl"))
    assert isinstance(parts.agent, SearchAgent)
    recall = parts.agent.components.image_recall
    assert recall is not None
    assert recall.config.prompt == "Where is a {goal}?"
    assert recall in parts.components
    assert parts.prompts["choose images"] == prompt_hash("Where is a {goal}?")
    without = build_agent(config)
    assert isinstance(without.agent, SearchAgent)
    assert without.agent.components.image_recall is None


def test_the_most_telling_images_come_first_and_only_those_of_earlier_searches(memory):
    images = images_of(memory)
    order = images.most_telling(0, before=2, most=3)
    assert len(order) == 3
    patches = {one.number: set(one.patches.tolist()) for one in images.kept}
    shown = [patches[number] for number in order]
    assert len(shown[0]) == max(len(one.patches) for one in images.kept)
    gains = [len(shown[k] - set().union(*shown[:k])) for k in range(3)]
    assert gains == sorted(gains, reverse=True)
    assert len(images.most_telling(0, before=2, most=1000)) == len(images.kept)
    assert images.most_telling(0, before=1, most=3) == ()
    assert images.most_telling(1, before=2, most=3) == ()


class Likes:
    """A model by which the goal's words fit some images better than the others."""

    def __init__(self, images: KeyImages, liked: Callable[[KeyImage], bool]) -> None:
        self.liked = {one.rgb.tobytes(): bool(liked(one)) for one in images.kept}
        self.seen = 0

    def image_vectors(self, image: np.ndarray) -> np.ndarray:
        self.seen += 1
        return np.array([[0.5 if self.liked[image.tobytes()] else 0.1, 1.0]], np.float32)

    def text_vectors(self, texts: Sequence[str]) -> np.ndarray:
        words = [[0.0 if text in NEUTRAL_WORDS else 1.0, 1.0] for text in texts]
        return np.array(words, np.float32)


MAY_BE = TOLD.replace("is in", "may be in")


def test_without_a_chat_model_the_robot_goes_to_what_looks_like_the_goal(memory):
    steps, result, _ = searched(
        "sofa", IN_BEDROOM, memory, similar=Likes(images_of(memory), shows_sofa)
    )
    assert steps[0].reason == MAY_BE
    assert kinds(steps) == ["rank images"]
    assert result.metrics.success
    assert result.metrics.spl > 0.8


@pytest.mark.parametrize("liked", [lambda one: False, lambda one: True])
def test_where_no_image_stands_out_the_search_is_as_without_a_model(memory, liked):
    similar = Likes(images_of(memory), liked)
    ranked, _, _ = searched("sofa", IN_BEDROOM, memory.copy(), similar=similar)
    steps, _, _ = searched("sofa", IN_BEDROOM, memory)
    assert similar.seen == len(similar.liked)
    assert [(one.action, one.reason) for one in ranked] == [
        (one.action, one.reason) for one in steps
    ]


def test_an_image_that_stands_out_in_vain_is_gone_to_once(memory):
    similar = Likes(images_of(memory), lambda one: one.number == 8)
    steps, result, _ = searched("piano", IN_BEDROOM, memory, similar=similar)
    told = MAY_BE.replace("sofa", "piano")
    assert [a.reason == told and b.reason != told for a, b in pairwise(steps)].count(True) == 1
    assert steps[-1].reason == "nothing is left to explore"
    assert result.metrics.success is False


def test_a_chat_model_is_asked_first_about_the_images_that_look_like_the_goal(memory):
    images = images_of(memory)
    order = images.most_telling(0, before=2, most=1000)
    last = next(one for one in images.kept if one.number == order[-1])
    similar = Likes(images, lambda one: one is last)
    steps, _, _ = searched("sofa", IN_BEDROOM, memory, "1", "none", similar=similar)
    assert kinds(steps)[:2] == ["rank images", "choose images"]
    assert steps[0].reason == TOLD
    assert steps[0].destination == last.robot.xy


@pytest.mark.parametrize("off", ["recall", "memory", "images"])
def test_nothing_is_compared_without_memory_images_or_leave_to(memory, off):
    similar = Likes(images_of(memory), shows_sofa)
    if off == "images":
        memory.images = None
    given = None if off == "memory" else memory
    steps, _, _ = searched("sofa", IN_BEDROOM, given, similar=similar, recall=off != "recall")
    assert similar.seen == 0
    assert "rank images" not in kinds(steps)


def test_a_model_that_fails_on_the_way_ends_the_search_as_every_component_does(memory):
    class Fails(Likes):
        def image_vectors(self, image: np.ndarray) -> np.ndarray:
            raise RuntimeError("out of memory")

    similar = through_door(Fails(images_of(memory), shows_sofa), ImageTextModel, "--similarity own")
    with pytest.raises(ComponentError, match="--similarity own: image_vectors raised"):
        searched("sofa", IN_BEDROOM, memory, similar=similar)
