import pytest

from habitat_room import habitat_config
from hypernav.core.errors import EpisodeError
from hypernav.lab.evaluation.habitat_lab.benchmark import HabitatBenchmark


class AheadAgent:
    """Goes straight for some steps, as agents of habitat-lab's own examples do, and stops."""

    def __init__(self, steps: int) -> None:
        self._most = steps

    def reset(self):
        self._steps = 0

    def act(self, observations):
        assert observations["rgb"].any()
        self._steps += 1
        return {"action": "move_forward" if self._steps <= self._most else "stop"}


def test_the_measures_are_means_over_the_episodes(room):
    benchmark = HabitatBenchmark(habitat_config(room))
    assert benchmark.evaluate(AheadAgent(10), num_episodes=1)["spl"] == pytest.approx(1.0, abs=1e-3)
    # Two of the three starts look at the goal.
    means = benchmark.evaluate(AheadAgent(10))
    assert means["success"] == pytest.approx(2.0 / 3.0)
    assert means["num_steps"] == 11.0
    assert means["collisions/count"] > 0.0
    assert means["collisions/is_collision"] == 0.0


@pytest.mark.parametrize("count", [0, 4])
def test_more_episodes_than_there_are_is_refused(room, count):
    with pytest.raises(EpisodeError, match="expected 1 to 3"):
        HabitatBenchmark(habitat_config(room)).evaluate(AheadAgent(1), num_episodes=count)
