from hypothesis import given
from hypothesis import strategies as st

from certainty import certain
from eval_runs import spec
from hypernav.core.episode import lives_of
from hypernav.lab.evaluation.runner import ATTEMPTS, Schedule


def of(*scenes):
    return Schedule(lives_of(spec(str(k), scene) for k, scene in enumerate(scenes)))


def test_a_worker_keeps_to_its_scene_while_that_has_episodes():
    schedule = of("a", "b", "a", "b", "a")
    order = []
    while (episode := schedule.next_for(0)) is not None:
        order.append(episode.scene_id)
        schedule.done(0)
    assert order == ["a", "a", "a", "b", "b"]
    assert schedule.is_finished


def test_two_workers_take_different_scenes_then_share_the_longest():
    schedule = of(*"aaaab")
    assert certain(schedule.next_for(0)).scene_id == "a"
    assert certain(schedule.next_for(1)).scene_id == "b"
    schedule.done(1)
    assert certain(schedule.next_for(1)).scene_id == "a"


def test_an_episode_of_a_lost_worker_is_tried_again_but_not_for_ever():
    schedule = of("a")
    for _ in range(ATTEMPTS - 1):
        assert schedule.next_for(0) is not None
        assert schedule.lost(0) is None
    episode = schedule.next_for(0)
    assert schedule.lost(0) == episode
    assert schedule.is_finished


def test_losing_an_idle_worker_costs_nothing():
    schedule = of("a")
    assert schedule.lost(3) is None
    assert schedule.left == 1


@given(
    scenes=st.lists(st.sampled_from("abcd"), max_size=30),
    workers=st.integers(1, 4),
    data=st.data(),
)
def test_every_episode_is_done_exactly_once_whoever_is_lost(scenes, workers, data):
    schedule, done = of(*scenes), []
    busy = {}
    while not schedule.is_finished:
        for worker in range(workers):
            if worker not in busy and (episode := schedule.next_for(worker)) is not None:
                busy[worker] = episode
        worker = data.draw(st.sampled_from(sorted(busy)))
        episode = busy.pop(worker)
        if data.draw(st.integers(0, 3)) == 0:
            given_up = schedule.lost(worker)
            done += [given_up] if given_up is not None else []
        else:
            assert schedule.done(worker) == episode
            done.append(episode)
    assert sorted(life.key[1] for life in done) == sorted(str(k) for k in range(len(scenes)))


@given(scenes=st.lists(st.sampled_from("abcdef"), max_size=60), workers=st.integers(1, 4))
def test_a_scene_is_loaded_at_most_once_by_a_worker(scenes, workers):
    schedule = of(*scenes)
    loaded = {worker: [] for worker in range(workers)}
    while not schedule.is_finished:
        for worker in range(workers):
            episode = schedule.next_for(worker)
            if episode is None:
                continue
            if loaded[worker][-1:] != [episode.scene_id]:
                begun = {scene for order in loaded.values() for scene in order}
                # A scene is shared only once there is none left to begin.
                assert episode.scene_id not in begun or begun == set(scenes)
                loaded[worker].append(episode.scene_id)
            schedule.done(worker)
    for order in loaded.values():
        assert len(order) == len(set(order))
