"""What a block holds."""

import pytest

from hypernav.core.exploring.overview import Block

BLOCK = Block(1, 2.0, -1.0, 2.0, 10, 3, (3.0, 0.0), 4.0)


@pytest.mark.parametrize(
    ("position", "is_inside"),
    [
        ((2.0, -1.0), True),
        ((3.9, 0.9), True),
        ((4.0, 0.0), False),
        ((3.0, 1.0), False),
        ((1.9, 0.0), False),
        ((3.0, -1.1), False),
    ],
)
def test_a_block_holds_its_lower_but_not_its_upper_edges(position, is_inside):
    assert BLOCK.holds(position) == is_inside
