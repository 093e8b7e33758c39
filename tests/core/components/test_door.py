"""Components of a user's own: the first wrong value and every failure have a name."""

import copy
import math
import os
import sys
from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from hypernav.core.components.abilities import ChecksGoal, Closes, Reports, gives_masks
from hypernav.core.components.door import ValueFault, checked, through_door
from hypernav.core.components.protocols import (
    Agent,
    ArrowReasoner,
    BlockReasoner,
    Detector,
    ExplainsItself,
    Explorer,
    Guide,
    ImageTextModel,
    PresenceCheck,
    SceneScorer,
    Segmenter,
)
from hypernav.core.embodiment import Action
from hypernav.core.errors import (
    ComponentError,
    ContractError,
    ModelUnavailableError,
    WorldError,
)
from hypernav.core.exploring.exploration import (
    Aim,
    Destination,
    ExplorationView,
    StairsDestination,
)
from hypernav.core.exploring.floors import KnownFloor, SeenThing, WayOut
from hypernav.core.exploring.guidance import (
    Arrow,
    ArrowChoice,
    ArrowView,
    Direction,
    GuideChoice,
    GuideView,
)
from hypernav.core.exploring.overview import (
    Block,
    BlockChoice,
    FloorBlocks,
    Overview,
)
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.box_room import BoxRoom

SEEN = BoxRoom().observe()
SHAPE = SEEN.depth.shape
GOAL = Goal("door")
GOOD = Detection(Box(1.0, 2.0, 30.0, 40.0), 0.5, "door")
BLOCK = Block(1, 0.0, 0.0, 1.0, 9, 3, (0.5, 0.5), 1.0)
OVERVIEW = Overview((BLOCK, replace(BLOCK, number=2)), Pose2(0.0, 0.0, 0.0))
THERE = Destination(1.0, 2.0, "x")
STAIRS = StairsDestination(1.0, 2.0, "x", 3, then=THERE)
GRID = OccupancyGrid(np.ones((4, 4), np.uint8), 0.05, (0.0, 0.0))
VIEW = ExplorationView(GOAL, SEEN, GRID, (), ways_out=[WayOut(3, 1.0, 2.0, "stairs up")])
THING = SeenThing("bed", (1.0, 2.0))
ARROW = Arrow(1, 0.0, 1.0, (1.0, 0.0), (5.0, 5.0), 1.0, False)
ARROWS = ArrowView(lambda: SEEN.rgb, (ARROW,), may_turn=True)


def own(**members: Any) -> Any:
    """A component of a user's own: functions become methods, all else attributes."""
    return type("Mine", (), members)()


def returning(method: str, value: object) -> Any:
    return own(**{method: lambda self, *given, **named: value})


def raising(error: BaseException) -> Callable[..., Any]:
    def fail(self: object, *_: object) -> None:
        raise error

    return fail


def broken(thing: Any, /, **values: Any) -> Any:
    """A value with members that a type checker would refuse."""
    made = copy.copy(thing)
    for name, value in values.items():
        object.__setattr__(made, name, value)
    return made


_VECTORS = ("image_vectors", "text_vectors")
DETECTED = {
    "no list": None,
    "a generator": (one for one in [GOOD]),
    "no detection": [GOOD, "door"],
    "no box": [broken(GOOD, box=(1, 2, 3, 4))],
    "an infinite box": [broken(GOOD, box=Box(0.0, 0.0, math.inf, 9.0))],
    "an inverted box": [broken(GOOD, box=Box(9.0, 0.0, 1.0, 9.0))],
    "NaN": [broken(GOOD, score=math.nan)],
    "5": [broken(GOOD, score=5)],
    "-1": [broken(GOOD, score=-1)],
    "a text as score": [broken(GOOD, score="high")],
    "True as score": [broken(GOOD, score=True)],
    "a mask of another size": [broken(GOOD, mask=np.ones((10, 10), bool))],
    "a float mask": [broken(GOOD, mask=np.ones(SHAPE))],
    "a 3-D mask": [broken(GOOD, mask=np.ones((*SHAPE, 1), bool))],
    "too many": [GOOD] * 1_001,
    "a label without end": [broken(GOOD, label="door" * 10_000)],
    "no label": [broken(GOOD, label=None)],
    "half a surrogate pair": [broken(GOOD, label="door\ud800")],
    "a whole number beyond all floats": [broken(GOOD, score=10**400)],
    "a corner beyond all floats": [broken(GOOD, box=Box(0.0, 0.0, 10**400, 9.0))],
    "a box without end": [broken(GOOD, box=Box(-1e300, -1e300, 1e300, 1e300))],
    "a goal that is neither": [broken(GOOD, is_goal="door")],
    "a masked array": [broken(GOOD, mask=np.ma.masked_array(np.ones(SHAPE, bool), mask=True))],
}
CASES = [
    *((Detector, "detect", (SEEN, GOAL), value) for value in DETECTED.values()),
    *((Detector, "name_things", (SEEN,), {1: value}) for value in (
        "bed", broken(THING, label=None), broken(THING, position=(1.0, math.nan)),
        broken(THING, position=(1.0,)), broken(THING, position=(1.0, 1e5)),
    )),
    *((Segmenter, "segment", (SEEN, GOOD.box), mask) for mask in (
        None, np.ones((10, 10), bool), np.ones(SHAPE, np.uint8), [[True]],
    )),
    *((PresenceCheck, "is_present", (SEEN, GOAL), value) for value in (math.nan, "no", 1, None)),
    *((SceneScorer, "score", (SEEN, GOAL), value) for value in (math.nan, 2.0, -1, None, "1")),
    *((Agent, "act", (SEEN,), value) for value in (7, -1, 1.0, True, "STOP", math.nan)),
    *((Explorer, "next_destination", (None,), value) for value in (
        (1.0, 2.0), broken(THERE, x=math.nan), broken(THERE, y=1e300), broken(THERE, face=math.nan),
        broken(THERE, face=math.inf),
        broken(THERE, most_steps=0.5), broken(THERE, reason=None), broken(THERE, blocks=[BLOCK]),
        broken(THERE, blocks=(1,)), broken(THERE, blocks=(replace(BLOCK, size_m=math.inf),)),
        broken(THERE, insight={}), broken(THERE, holds="no"), STAIRS, Aim(1.0, 2.0, "x"),
    )),
    *((Explorer, "next_destination", (VIEW,), value) for value in (
        broken(STAIRS, then=(1.0, 2.0)), replace(STAIRS, then=replace(THERE, x=1e300)),
        replace(STAIRS, connector=1), replace(STAIRS, then=replace(STAIRS, connector=1)),
    )),
    *((BlockReasoner, "choose", (OVERVIEW, GOAL, frozenset({2})), value) for value in (
        None, 1, BlockChoice(2, "excluded"), BlockChoice(9, "not there"),
        broken(BlockChoice(1, "x"), number=True), broken(BlockChoice(1, "x"), number=1.0),
    )),
    *((ArrowReasoner, "choose", (ARROWS, GOAL), value) for value in (
        None, ArrowChoice((7,), "not there"), broken(ArrowChoice((), "x"), numbers=[1]),
    )),
    *((Guide, "direct", (None, GOAL), value) for value in (
        "left", broken(GuideChoice(Direction.LEFT, "x"), direction="left"),
    )),
    *((ImageTextModel, "image_vectors", (np.zeros((4, 4, 3), np.uint8),), value) for value in (
        None, [[1.0]], np.ones(3), np.ones((1, 3), int), np.zeros((0, 3)), np.zeros((1, 3)),
        np.array([[1.0, math.nan]]), np.array([[1e300]]),
        np.array([[1e30]]), np.array([[1e-30]]),
    )),
    *((ImageTextModel, "text_vectors", (("a bed", "a sofa"),), value) for value in (
        np.ones((1, 3)), np.array([[1.0], [0.0]]),
    )),
    *((protocol, "take_report", (), value) for protocol, value in (
        (Detector, None), (Agent, {"a": math.nan}), (Explorer, {"a": object()}),
        (Detector, {"a": "\ud800"}),
    )),
]  # fmt: skip


@pytest.mark.parametrize(("protocol", "method", "given", "value"), CASES, ids=range(len(CASES)))
def test_the_first_wrong_value_names_the_component(protocol, method, given, value):
    needed = dict.fromkeys((one for one in dir(protocol) if one[0] != "_"), lambda self: None)
    mine = own(**{**needed, method: lambda self, *given: value})
    with pytest.raises(ComponentError, match=rf"^--kind mine: {method} returned .*expected"):
        getattr(through_door(mine, protocol, "--kind mine"), method)(*given)


class Lazy(list[Any]):
    def __iter__(self) -> Any:
        sys.exit(0)


class Unspeakable:
    def __repr__(self) -> str:
        sys.exit(0)


class Unsure(int):
    def __int__(self) -> int:
        sys.exit(0)


@pytest.mark.parametrize(
    ("protocol", "method", "value"),
    [(Detector, "detect", Lazy()), (Detector, "detect", Unspeakable()), (Agent, "act", Unsure(0))],
)
def test_what_comes_back_cannot_end_the_program_while_it_is_looked_at(protocol, method, value):
    needed = dict.fromkeys((one for one in dir(protocol) if one[0] != "_"), lambda self: None)
    mine = through_door(own(**{**needed, method: lambda self, *given: value}), protocol)
    with pytest.raises(ComponentError, match=f"^Mine: what {method} returned ended the program"):
        getattr(mine, method)(SEEN, GOAL)


def test_an_attribute_that_says_neither_yes_nor_no_is_named():
    mine = own(detect=lambda self, *given: [], gives_masks=np.array([1, 2]))
    with pytest.raises(ComponentError, match=r"^Mine: gives_masks returned .*expected True or"):
        gives_masks(through_door(mine, Detector))


@pytest.mark.parametrize("score", [0, 0.0, -1e-7, 0.3, 1, 1.0, 1.0 + 1e-7, np.float32(1.0)])
def test_scores_from_0_to_1_pass_with_their_rounding(score: float):
    detector = through_door(returning("detect", [broken(GOOD, score=score)]), Detector)
    assert detector.detect(SEEN, GOAL)[0].score == score
    scorer = through_door(returning("score", score), SceneScorer)
    assert scorer.score(SEEN, GOAL) == score


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("grid", 5, "OccupancyGrid or None"),
        ("last_step", None, "StepTrace"),
        ("embodiment", None, "Embodiment"),
        ("warning", 5, "str"),
        ("embodiment", len, "Embodiment"),
    ],
)
def test_an_attribute_of_another_class_is_named(name: str, value: object, expected: str):
    mine = own(reset=lambda self, goal: None, act=lambda self, seen: 2, **{name: value})
    with pytest.raises(ComponentError, match=rf"^Mine: {name} returned .*; expected {expected}"):
        getattr(through_door(mine, Agent), name)


def test_an_agent_may_have_no_map():
    mine = own(reset=lambda self, goal: None, act=lambda self, seen: 2, grid=None)
    assert through_door(mine, Agent).grid is None


def test_good_values_pass():
    mask = np.ones(SHAPE, bool)
    found = [GOOD, broken(GOOD, mask=mask, score=1.0000001, box=Box(0, 0, 0, 0))]
    detector = through_door(returning("detect", tuple(found)), Detector)
    assert detector.detect(observation=SEEN, goal=GOAL) == found
    assert through_door(returning("segment", mask), Segmenter).segment(SEEN, GOOD.box) is mask
    present = through_door(returning("is_present", np.bool_(True)), PresenceCheck)
    assert present.is_present(SEEN, GOAL) is True
    agent = through_door(own(reset=lambda self, goal: None, act=lambda self, seen: 2), Agent)
    assert agent.act(SEEN) is Action.TURN_LEFT
    reasoner = through_door(returning("choose", BlockChoice(1, "near")), BlockReasoner)
    assert reasoner.choose(OVERVIEW, GOAL, frozenset()).number == 1
    arrows = through_door(returning("choose", ArrowChoice((0,), "back")), ArrowReasoner)
    assert arrows.choose(ARROWS, GOAL).numbers == (0,)
    guide = through_door(returning("direct", GuideChoice(Direction.LEFT, "x")), Guide)
    assert guide.direct(None, GOAL).direction is Direction.LEFT  # pyright: ignore[reportArgumentType]
    vectors = np.array([[3.0, 4.0], [0.0, 1.0]])
    model = through_door(
        own(**dict.fromkeys(_VECTORS, lambda self, given: vectors)), ImageTextModel
    )
    assert model.image_vectors(SEEN.rgb).tolist() == vectors.tolist()
    assert model.text_vectors(["a bed", "a sofa"]).dtype == np.float32
    explorer = through_door(returning("next_destination", None), Explorer)
    assert explorer.next_destination(None) is None  # pyright: ignore[reportArgumentType]
    there = replace(THERE, blocks=(replace(BLOCK, travel_m=math.inf),), face=0.5)
    for one in (there, STAIRS, replace(STAIRS, then=replace(STAIRS, then=there))):
        explorer = through_door(returning("next_destination", one), Explorer)
        assert explorer.next_destination(VIEW) is one


def test_numbers_of_numpy_become_those_that_files_can_hold():
    there = broken(THERE, x=np.float32(0.5), most_steps=np.int64(3), holds=np.bool_(True))
    explorer = through_door(returning("next_destination", there), Explorer)
    found = explorer.next_destination(None)  # pyright: ignore[reportArgumentType]
    assert found == replace(THERE, x=0.5, most_steps=3, holds=True)
    assert found is not None
    assert [type(one) for one in (found.x, found.most_steps, found.holds)] == [float, int, bool]


@pytest.mark.parametrize(
    "kind",
    [
        *(ArrowChoice, Block, BlockChoice, Box, Destination, Detection, GuideChoice, SeenThing),
        StairsDestination,
    ],
)
def test_every_field_of_what_components_return_is_checked(kind):
    mine = (BLOCK, GOOD.box, THERE, GOOD, THING, STAIRS)
    good = {type(one): one for one in mine}
    made = good.get(kind) or {
        ArrowChoice: ArrowChoice((1,), "x"),
        BlockChoice: BlockChoice(1, "x"),
        GuideChoice: GuideChoice(Direction.LEFT, "x"),
    }[kind]  # fmt: skip
    for field in fields(kind):
        if field.name == "mask":  # an array, whose shape is the image's
            continue
        with pytest.raises(ValueFault, match=f"{field.name} <object object"):
            checked(broken(made, **{field.name: object()}), kind)


@pytest.mark.parametrize(
    "error",
    [
        KeyError("mine"),
        SystemExit(0),
        SystemExit(),
        WorldError("over"),
        MemoryError(),
        GeneratorExit(),
    ],
)
def test_whatever_it_raises_is_its_own(error):
    mine = through_door(own(detect=raising(error)), Detector, "--detector mine:Mine")
    with pytest.raises(ComponentError, match=r"^--detector mine:Mine: detect") as caught:
        mine.detect(SEEN, GOAL)
    assert type(error).__name__ in str(caught.value)
    assert f"{__file__} line" in str(caught.value)
    assert "in fail" in caught.value.details


@pytest.mark.parametrize("error", [KeyboardInterrupt(), ModelUnavailableError("no\n server")])
def test_interruptions_and_outages_pass_unchanged(error):
    words = str(error)
    with pytest.raises(type(error)) as caught:
        through_door(own(detect=raising(error)), Detector).detect(SEEN, GOAL)
    assert caught.value is error
    assert str(error) == words


def test_a_process_of_its_own_may_become_another():
    def detect(self: object, *_: object) -> list[Detection]:
        child = os.fork()
        if child == 0:
            os.execv("/bin/sh", ["sh", "-c", "exit 7"])
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        return []

    assert through_door(own(detect=detect), Detector).detect(SEEN, GOAL) == []


def test_what_it_draws_on_an_image_nobody_else_sees():
    seen = BoxRoom().observe()
    rgb, depth = seen.rgb.copy(), seen.depth.copy()

    def detect(self: object, observation: Observation, goal: Goal) -> list[Detection]:
        observation.rgb[:] = 0
        observation.depth[:] = 0.3
        return []

    through_door(own(detect=detect), Detector).detect(seen, GOAL)
    through_door(own(detect=detect), Detector).detect(observation=seen, goal=GOAL)
    np.testing.assert_array_equal(seen.rgb, rgb)
    np.testing.assert_array_equal(seen.depth, depth)


def test_what_it_draws_on_a_view_nobody_else_sees():
    seen = BoxRoom().observe()
    rgb = seen.rgb.copy()
    grid = OccupancyGrid(np.ones((4, 4), np.uint8), 0.05, (0.0, 0.0))
    floor = KnownFloor(1, 3.0, grid, (), (), (), (), (), (0.0, 0.0))
    elsewhere = [FloorBlocks(floor, ())]

    def next_destination(self: object, view: ExplorationView) -> None:
        for drawn in (view.observation.rgb, view.grid.cells, view.elsewhere[0].grid.cells):
            drawn[:] = 0
        view.notes["mine"] = 1

    def choose(self: object, overview: Overview, *_: object) -> BlockChoice:
        assert overview.camera_image is not None
        overview.camera_image[:] = 0
        overview.elsewhere[0].known.grid.cells[:] = 0
        return BlockChoice(1, "x")

    def direct(self: object, view: GuideView, goal: Goal) -> GuideChoice:
        view.images[0][:] = 0
        return GuideChoice(Direction.LEFT, "x")

    view = ExplorationView(GOAL, seen, grid, (), elsewhere=[floor])
    overview = replace(OVERVIEW, camera_image=seen.rgb, elsewhere=elsewhere)
    through_door(own(next_destination=next_destination), Explorer).next_destination(view)
    through_door(own(choose=choose), BlockReasoner).choose(overview, GOAL, frozenset())
    through_door(own(direct=direct), Guide).direct(GuideView(seen, {}), GOAL)
    np.testing.assert_array_equal(seen.rgb, rgb)
    assert grid.cells.all()
    assert view.notes == {"mine": 1}


def test_what_else_it_can_do_is_kept():
    mine = own(
        detect=lambda self, seen, goal: [],
        check_goal=raising(ValueError("never seen")),
        close=lambda self: os.getpid(),
        gives_masks=True,
    )
    shell = through_door(mine, Detector)
    assert isinstance(shell, ChecksGoal)
    assert isinstance(shell, Closes)
    assert not isinstance(shell, Reports | ExplainsItself | Agent)
    assert shell.gives_masks  # pyright: ignore[reportAttributeAccessIssue]
    assert type(shell).__name__ == "Mine"
    with pytest.raises(ComponentError, match=r"Mine: check_goal raised .*never seen"):
        shell.check_goal(GOAL)
    assert not hasattr(shell, "something_else")


def test_a_component_of_this_package_passes_unchanged():
    ours = GroundTruthDetector()
    assert through_door(ours, Detector) is ours


@pytest.mark.parametrize("thing", [{}, object(), Detector, GroundTruthDetector])
def test_what_is_no_component_is_refused(thing):
    with pytest.raises(ContractError, match=r"is no Detector: it has no detect|is a class"):
        through_door(thing, Detector)


def test_a_component_that_cannot_be_looked_at_is_named():
    mine = own(detect=property(lambda self: sys.exit(0)))
    with pytest.raises(ComponentError, match="Mine: a look at it ended the program"):
        through_door(mine, Detector)
