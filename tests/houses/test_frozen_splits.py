from collections import Counter

import pytest

from hypernav.build.data.datasets import fingerprint, load_episodes
from hypernav.houses.episodes.splits import load_split

FROZEN = {
    "offices-val": "cecb77ebb4bc1fb0",
    "shops-val": "0c54882cf6778612",
    "storeys-val": "3731e60ced8193fb",
    "houses-life-val": "114147a6a443e7ab",
    "offices-life-val": "becc5c3031b0d88f",
    "storeys-life-val": "8a45e0b993739dd5",
}
"""Fingerprints of the splits whose episodes never change."""


@pytest.mark.freeze
@pytest.mark.parametrize(("name", "expected"), FROZEN.items())
def test_a_frozen_split_has_the_episodes_that_were_measured(name: str, expected: str):
    assert fingerprint(load_episodes(name)) == expected


@pytest.mark.freeze
def test_a_third_of_the_goals_is_on_the_storey_of_the_start_a_third_above_and_a_third_below():
    where = Counter((e.info or {})["goal_is"] for e in load_split("storeys-val").episodes)
    assert where == {"same": 100, "above": 100, "below": 100}
