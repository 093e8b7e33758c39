"""What VLMnav's and PIVOT's released code does, and its mistakes as switches."""

import math

import pytest

from arrow_views import arrow, room_with_wall, view_of
from chat_models import Parrot
from exploration_views import exploration_view
from hypernav.app.build.presets import preset
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.errors import ModelUnavailableError
from hypernav.core.exploring.guidance import ArrowChoice
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import SearchMemory
from hypernav.search.rivals.arrows.arrow_explorer import (
    DynavlmStyleExplorer,
    VlmnavExplorer,
)
from hypernav.search.rivals.arrows.arrow_reasoners import ChatArrowReasoner
from hypernav.search.rivals.arrows.pivot import PivotExplorer
from hypernav.search.rivals.arrows.proposals import DEFAULT_MOVES, Move
from hypernav.search.rivals.config import ArrowsConfig

BED = Goal("bed")
ROBOT = Embodiment(camera=CameraConfig(width=320, height=240))
GRID = OccupancyGrid(room_with_wall().rgb[:, :, 0] * 0 + 1, 0.05, (-6.0, -6.0))


class Says:
    """Names the numbers that it is told to, once for each question; notes what it was shown."""

    def __init__(self, *numbers):
        self.numbers, self.views = numbers, []

    def choose(self, view, goal):
        self.views.append(view)
        return ArrowChoice(self.numbers, "because")


def move_of(explorer, search=None, *, may_be_here=False):
    view = exploration_view(GRID, room_with_wall(4.0), search, may_be_here=may_be_here)
    return explorer.next_destination(view)


def text_of(arrows: int, *, may_turn: bool, count_short: bool) -> str:
    chat = Parrot('{"action": 1}')
    reasoner = ChatArrowReasoner(chat, ExchangeLog(), ArrowsConfig(count_short=count_short))
    reasoner.choose(view_of(*map(arrow, range(1, arrows + 1)), may_turn=may_turn), BED)
    return chat.asked[0].text


@pytest.mark.parametrize(
    ("may_turn", "count_short", "last"),
    [(True, True, 4), (False, True, 3), (True, False, 4), (False, False, 4)],
)
def test_the_number_of_arrows_is_one_short_where_turning_is_barred(may_turn, count_short, last):
    text = text_of(4, may_turn=may_turn, count_short=count_short)
    assert f"numbers 1 to {last} show" in text


@pytest.mark.parametrize("name", ["vlmnav-as-released", "pivot-as-released"])
def test_an_outage_is_an_outage_for_released_code_too(name):
    chat = Parrot(ModelUnavailableError("no answer for 60 s"))
    reasoner = ChatArrowReasoner(chat, ExchangeLog(), preset(name).arrows)
    with pytest.raises(ModelUnavailableError):
        reasoner.choose(view_of(arrow(1)), BED)


def test_zero_is_the_last_mark():
    reasoner = Says(0)
    move = move_of(PivotExplorer(reasoner, ROBOT, ArrowsConfig(zero_is_last=True)))
    assert move.face is None
    assert move.xy == reasoner.views[-1].arrows[-1].end
    assert move_of(PivotExplorer(Says(0), ROBOT)).face is not None  # else it turns around


def test_a_blind_step_has_its_own_length():
    config = ArrowsConfig(blind_step_m=0.2)
    explorer = VlmnavExplorer(Says(), ROBOT, MappingConfig(), (0.2,), config)
    assert move_of(explorer).xy == pytest.approx((0.2, 0.0))


@pytest.mark.parametrize(
    ("kind", "offered"), [(VlmnavExplorer, [1, 2, 3]), (DynavlmStyleExplorer, [1])]
)
def test_vlmnav_offers_arrows_whose_marks_overlap(monkeypatch, kind, offered):
    moves = [Move(math.radians(angle), 1.7) for angle in (2.0, 1.0, 0.0)]
    monkeypatch.setattr(kind, "_proposed", lambda *others, may_turn: moves)
    reasoner = Says(1)
    move_of(kind(reasoner, ROBOT, MappingConfig(), (0.2,)))
    assert [one.number for one in reasoner.views[0].arrows] == offered


def test_after_a_yes_only_the_default_moves_are_offered_once():
    reasoner, search = Says(1), SearchMemory()
    explorer = VlmnavExplorer(reasoner, ROBOT, MappingConfig(), (0.2,))
    move_of(explorer, search, may_be_here=True)
    move_of(explorer, search)
    first, second = reasoner.views
    headings = {move.heading for move in DEFAULT_MOVES}
    assert {one.heading for one in first.arrows} <= headings
    assert not first.may_turn
    assert second.may_turn
