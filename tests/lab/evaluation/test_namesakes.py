"""Scene files of the same name are not mistaken for each other."""

import pytest

from eval_runs import spec
from hypernav.app.build.data.datasets import select
from hypernav.core.errors import EpisodeError
from hypernav.lab.evaluation.workers.worker import folder_name

NAMESAKES = [spec("0", "a/room.glb"), spec("0", "b/room.glb")]


def test_a_name_that_two_scenes_share_is_refused():
    with pytest.raises(EpisodeError, match=r"2 scenes: a/room\.glb, b/room\.glb"):
        select(NAMESAKES, scenes="room")
    assert select(NAMESAKES, scenes="b/room.glb") == NAMESAKES[1:]


def test_each_saved_episode_has_a_folder_of_its_own():
    near = [*NAMESAKES, spec("A", "house"), spec("a", "house"), spec("x" * 200), spec("x" * 201)]
    assert len({folder_name(episode) for episode in near}) == len(near)
    assert all(len(folder_name(episode)) < 130 for episode in near)
