"""Who chooses an arrow, with a model and without."""

import pytest

from arrow_views import HERE, arrow, room_with_wall, view_of
from chat_models import Parrot
from exploration_views import exploration_view
from hypernav.core.components.abilities import wants_named_things
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.exploring.floors import SeenThing
from hypernav.core.exploring.guidance import TURN_AROUND, ArrowChoice
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import SearchMemory
from hypernav.search.rivals.arrows import arrow_explorer
from hypernav.search.rivals.arrows.arrow_explorer import (
    DynavlmStyleExplorer,
    ObjectGraph,
    VlmnavExplorer,
)
from hypernav.search.rivals.arrows.arrow_reasoners import (
    ChatArrowReasoner,
    GeometricArrowReasoner,
)
from hypernav.search.rivals.arrows.pivot import PivotExplorer

BED = Goal("bed")
ROBOT = Embodiment(camera=CameraConfig(width=320, height=240))


def geometric(*arrows, **options):
    return GeometricArrowReasoner(ExchangeLog()).choose(view_of(*arrows, **options), BED).numbers


def test_without_a_model_the_freest_unexplored_arrow_is_taken():
    known, near, far = arrow(1, free_m=5.0, explored=True), arrow(2), arrow(3, free_m=3.0)
    assert geometric(known, near, far) == (3,)
    assert geometric(known, near, far, wanted=2) == (3, 2)


def test_it_says_which_arrow_it_takes_and_how_far_that_leads():
    log = ExchangeLog()
    view = view_of(arrow(1, free_m=3.25), arrow(2, free_m=5.5), arrow(3), wanted=3)
    choice = GeometricArrowReasoner(log).choose(view, BED)
    assert choice == ArrowChoice((2, 1, 3), "arrow 2: unexplored, free for 5.5 m")
    (noted,) = log.drain()
    assert (noted.chosen, noted.answer) == (2, choice.reason)


def test_where_all_is_explored_it_turns_or_draws_the_same_again():
    arrows = [arrow(number, explored=True) for number in range(1, 6)]
    assert geometric(*arrows) == (TURN_AROUND,)
    drawn = geometric(*arrows, may_turn=False)
    assert drawn == geometric(*arrows, may_turn=False)
    later = {geometric(*arrows, may_turn=False, asked=number) for number in range(20)}
    assert len(later) > 1  # or the robot would go in circles
    assert len(geometric(*arrows, may_turn=False, wanted=3)) == 3
    assert geometric(may_turn=False) == ()


def asked(says, *arrows, **options):
    log, chat = ExchangeLog(), Parrot(says)
    reasoner = ChatArrowReasoner(chat, log)
    choice = reasoner.choose(view_of(*arrows, **options), Goal("an umbrella"))
    return choice, chat.asked[0].text, log.drain()[0], reasoner.take_report()


@pytest.mark.parametrize(
    ("says", "numbers"),
    [
        ('A hall. I go left. {"action": 2}', (2,)),
        ('{"action": 1} no, rather {"action": "arrow 2"}', (2,)),
        ("{'action': 2}", (2,)),
        ('{"action": 0}', (0,)),
        ('{"action": 7}', ()),
        ("arrow 2", ()),
        ("{}", ()),
    ],
)
def test_the_last_json_object_counts(says, numbers):
    choice, _, exchange, report = asked(says, arrow(1), arrow(2))
    assert choice.numbers == numbers
    assert exchange.chosen == (numbers[0] if numbers else None)
    assert report == {"unread_arrow_answers": int(not numbers)}


def test_turning_can_be_answered_only_where_it_is_offered():
    choice, text, _, _ = asked('{"action": 0}', arrow(1), may_turn=False)
    assert choice.numbers == ()
    assert "turns it around" not in text
    assert "an umbrella" in text


def test_several_are_asked_for_and_no_more_are_taken():
    arrows = [arrow(number) for number in range(1, 6)]
    choice, text, _, _ = asked('{"actions": [3, 3, 9, 1, 2]}', *arrows, wanted=2)
    assert choice.numbers == (3, 1)
    assert "Which 2 of them" in text


def test_what_is_remembered_stands_in_the_question():
    _, text, _, _ = asked('{"action": 1}', arrow(1), facts=("bed, 2.0 m, straight ahead",))
    assert "bed, 2.0 m, straight ahead" in text


GRID = OccupancyGrid(room_with_wall().rgb[:, :, 0] * 0 + 1, 0.05, (-6.0, -6.0))


class Says:
    """Names what it is told to; notes what it was shown."""

    def __init__(self, *numbers):
        self.numbers, self.views = numbers, []

    def choose(self, view, goal):
        self.views.append(view)
        return ArrowChoice(self.numbers, "because")


def move_of(explorer, search=None, *, robot=HERE, goal=BED, things=()):
    seen = room_with_wall(4.0, robot=robot)
    return explorer.next_destination(exploration_view(GRID, seen, search, goal=goal, things=things))


def explorer_of(reasoner):
    return VlmnavExplorer(reasoner, ROBOT, MappingConfig(), (0.2,))


def test_the_end_of_the_chosen_arrow_is_the_destination():
    reasoner = Says(1)
    move = move_of(explorer_of(reasoner))
    assert move.xy == reasoner.views[0].arrow(1).end
    assert move.holds
    assert move.arrival_m == 0.25


def test_zero_turns_around_and_is_then_not_offered_for_three_choices():
    reasoner, search = Says(0), SearchMemory()
    explorer = explorer_of(reasoner)
    move = move_of(explorer, search, robot=Pose2(1.0, 2.0, 0.5))
    assert move.xy == (1.0, 2.0)
    assert move.face == pytest.approx(0.5 + 3.14159, abs=1e-4)
    reasoner.numbers = (1,)
    offered = []
    for _ in range(4):
        move_of(explorer, search)
        offered.append(reasoner.views[-1].may_turn)
    assert offered == [False, False, False, True]


def test_an_answer_without_a_number_is_a_step_ahead():
    move = move_of(explorer_of(Says()))
    assert move.xy == pytest.approx((0.5, 0.0))


def test_pivot_asks_three_times_a_round_and_goes_to_the_last_best():
    reasoner = Says(1, 2, 3)
    move = move_of(PivotExplorer(reasoner, ROBOT))
    assert len(reasoner.views) == 9
    assert [len(one.arrows) for one in reasoner.views[::3]] == [8, 6, 4]
    assert [one.wanted for one in reasoner.views[::3]] == [4, 3, 2]
    assert move.xy == reasoner.views[-1].arrow(1).end
    assert (move.x**2 + move.y**2) ** 0.5 == pytest.approx(1.7)


def test_equal_seeds_give_equal_pivot_walks_and_other_goals_others():
    def walk(goal):
        explorer, search = PivotExplorer(Says(1), ROBOT), SearchMemory()
        return [move_of(explorer, search, goal=goal).xy for _ in range(5)]

    assert walk(BED) == walk(BED)
    assert walk(BED) != walk(Goal("sofa"))


def test_pivot_without_an_answer_takes_a_step():
    assert move_of(PivotExplorer(Says(), ROBOT)).xy == pytest.approx((0.5, 0.0))


def test_things_of_one_name_are_one_where_they_are_near():
    beds = [SeenThing("bed", at) for at in ((2.0, 0.0), (2.5, 0.5), (5.0, 0.0))]
    others = [SeenThing("nightstand", (3.0, 1.0)), SeenThing("oven", (-4.0, 0.0))]
    graph = ObjectGraph([*beds, *others])
    assert [one.position[0] for one in graph.shown(BED, HERE).things] == [2.0, 5.0, 3.0, -4.0]
    facts = graph.retrieve(Goal("pillow"), HERE)
    assert facts[-1].startswith("oven, ")  # it stands where no pillow lies
    assert "bed, 2.0 m, straight ahead, near nightstand" in facts
    (stand,) = (fact for fact in facts if fact.startswith("nightstand"))
    assert "18° to the left" in stand


def test_people_see_the_whole_memory_and_what_of_it_is_told(monkeypatch):
    monkeypatch.setattr(arrow_explorer, "_MOST_FACTS", 1)
    bed, stand = SeenThing("bed", (2.0, 0.0)), SeenThing("nightstand", (3.0, 1.0))
    things = [bed, stand, SeenThing("oven", (-4.0, 0.0))]
    graph = ObjectGraph(things)
    shown = graph.shown(BED, HERE)
    assert [one.label for one in shown.things] == ["bed", "nightstand", "oven"]
    assert [one.told for one in shown.things] == [True, False, False]
    assert shown.near == [(0, 1)]


def test_memory_joins_the_question_and_the_explorer_keeps_none_of_it():
    reasoner = Says(1)
    explorer = DynavlmStyleExplorer(reasoner, ROBOT, MappingConfig(), (0.2,))
    move_of(explorer, things=[SeenThing("oven", (2.0, 1.0))])
    assert "oven" in reasoner.views[0].facts[0]
    move_of(explorer)
    assert reasoner.views[1].facts == ()


def test_only_a_memory_of_things_wants_them_named():
    assert wants_named_things(DynavlmStyleExplorer(Says(1), ROBOT, MappingConfig(), (0.2,)))
    assert not wants_named_things(explorer_of(Says(1)))
