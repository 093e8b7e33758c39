"""Searches with stand-ins are kept, resumed and summed up."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from exam_answers import TRUE_BOX, boxed, checked, chose
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.exam.prediction import searches
from hypernav.lab.exam.prediction.confusion import Confusion, confusion_of
from hypernav.lab.exam.prediction.outlook import predictions_of
from hypernav.lab.exam.prediction.searches import SearchedEpisode, mimics_of, run_searches
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

START = Pose2(1.5, 3.2, 0.0)
COSTS = {"1": 5.0, "2": 9.0, "3": 12.0}
PERFECT = [
    *(boxed("near", TRUE_BOX), boxed("far", TRUE_BOX), boxed("absent", None)),
    *(checked("there", "yes"), checked("not there", "no"), chose(1, COSTS)),
]
NAY = [*PERFECT[:3], checked("there", "no"), checked("not there", "no"), chose(1, COSTS)]


@pytest.fixture(autouse=True)
def two_rooms_only(monkeypatch: pytest.MonkeyPatch) -> None:
    world = two_rooms.__wrapped__()  # not the one that other tests share
    monkeypatch.setattr(searches, "open_world", lambda *_, **__: world)
    monkeypatch.setattr(type(world), "close", lambda _: None)


def ran(folder: Path, confusion: Confusion, episodes: int = 1) -> list[SearchedEpisode]:
    folder.mkdir(exist_ok=True)
    config = small_config()
    wanted = [replace(episode_from(START), episode_id=str(k)) for k in range(episodes)]
    agents = mimics_of(confusion, {"default": config, "paper": small_config("paper")})
    return run_searches(agents, config, wanted, folder / searches.SEARCHES, lambda _: None)


@pytest.mark.slow
def test_who_knows_everything_finds_the_goal_and_who_denies_it_only_unasked(tmp_path: Path):
    perfect = predictions_of(ran(tmp_path, confusion_of(PERFECT)))
    assert [one.preset for one in perfect] == ["default", "paper"]
    assert all(one.success.mean == 1.0 and 0.0 < one.spl.mean <= 1.0 for one in perfect)
    assert all(one.asked["ground"] >= 1.0 for one in perfect)
    denied = predictions_of(ran(tmp_path / "nay", confusion_of(NAY)))
    assert all(one.spl.mean == 0.0 for one in denied)
    assert all("presence" in one.leave_out for one in denied)
    assert all(one.without["presence"].difference.mean > 0.0 for one in denied)
    assert all("verify" in one.asked for one in denied)
    assert all("verify" not in one.asked_without["presence"] for one in denied)
    assert all("choose block" not in one.asked_without["block"] for one in perfect)


@pytest.mark.slow
def test_finished_searches_are_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    first = ran(tmp_path, confusion_of(PERFECT))
    more = ran(tmp_path, confusion_of(PERFECT), episodes=2)
    assert more[0] == first[0]
    monkeypatch.setattr(searches, "EpisodeRun", partial(pytest.fail, "it searches again"))
    assert ran(tmp_path, confusion_of(PERFECT), episodes=2) == more


def test_what_was_not_examined_is_as_without_a_model(tmp_path: Path):
    confusion = confusion_of([chose(1, COSTS)])
    found = ran(tmp_path, confusion)
    assert {one.variant for one in found[0].searches} == {"model", "rule"}
    assert all("ground" not in one.asked for one in found[0].searches)
