"""What a score says about a candidate."""

from itertools import pairwise

from hypernav.search.perception.local.belief import _YOLOX


def test_a_higher_score_never_speaks_less_for_the_goal():
    scores = [score for score, _ in _YOLOX]
    shifts = [shift for _, shift in _YOLOX]
    assert all(a < b for values in (scores, shifts) for a, b in pairwise(values))
    assert (scores[0], scores[-1]) == (0.0, 1.0)
