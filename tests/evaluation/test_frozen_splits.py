import pytest

from hypernav.build.data.datasets import fingerprint, load_episodes

FROZEN = {
    "offices-val": "cecb77ebb4bc1fb0",
    "shops-val": "0c54882cf6778612",
}
"""Fingerprints of the splits whose episodes never change."""


@pytest.mark.freeze
@pytest.mark.parametrize(("name", "expected"), FROZEN.items())
def test_a_frozen_split_has_the_episodes_that_were_measured(name: str, expected: str):
    assert fingerprint(load_episodes(name)) == expected
