"""What a component that says nothing of itself is taken for, and that its word counts."""

import pytest

from hypernav.core.components import abilities
from hypernav.core.score_weights import MISSED


@pytest.mark.parametrize(
    ("asked", "name", "unsaid", "said"),
    [
        (abilities.looks_at_colours, "looks_at_colours", True, False),
        (abilities.wants_named_things, "wants_named_things", False, True),
        (abilities.gives_masks, "gives_masks", False, True),
        (abilities.looks_closer, "looks_closer", True, False),
        (abilities.answers_at_once, "answers_at_once", False, True),
        (abilities.warning_of, "warning", "", "mind the step"),
        (abilities.score_weights_of, "score_weights", (), ((0.0, -1.0), (1.0, 1.0))),
        (abilities.missed_weight_of, "missed_weight", MISSED, -0.25),
    ],
)
def test_a_component_is_what_it_says_of_itself_or_else_the_usual(asked, name, unsaid, said):
    assert asked(object()) == unsaid
    assert asked(type("Mine", (), {name: said})()) == said
