from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from hypernav.search.drawing.label_placement import Label, placed_labels

HEIGHT = 16.0
PIXELS = st.floats(0.0, 400.0)
LABELS = st.lists(
    st.builds(Label, st.sampled_from(["sofa", "lamp", "rug"]), PIXELS, PIXELS, st.just(40.0)),
    max_size=25,
)


@given(LABELS)
def test_no_label_covers_another(labels):
    for one, other in combinations(placed_labels(labels, HEIGHT), 2):
        assert abs(one.u - other.u) >= 40.0 or abs(one.v - other.v) >= HEIGHT


@given(LABELS)
def test_a_label_stays_within_two_rows_of_its_thing(labels):
    things = [label._replace(v=0.0) for label in labels]
    for placed in placed_labels(labels, HEIGHT):
        assert placed._replace(v=0.0) in things
        rows = [abs(placed.v - one.v) for one in labels if one.u == placed.u]
        assert min(rows) <= 2.0 * HEIGHT + 1e-9


def test_labels_apart_stay_where_their_things_are():
    labels = [Label("sofa", 50.0, 50.0, 40.0), Label("lamp", 200.0, 50.0, 40.0)]
    assert placed_labels(labels, HEIGHT) == labels


def test_of_two_things_at_one_position_the_second_is_named_a_row_beside():
    labels = [Label("sofa", 50.0, 50.0, 40.0), Label("lamp", 50.0, 50.0, 40.0)]
    assert placed_labels(labels, HEIGHT)[1] == Label("lamp", 50.0, 34.0, 40.0)


def test_one_of_several_equal_names_in_a_row_is_enough():
    cabinets = [Label("cabinet", 50.0 + 30.0 * k, 50.0, 40.0) for k in range(3)]
    assert placed_labels(cabinets, HEIGHT) == cabinets[:1]
    assert len(placed_labels([cabinets[0], cabinets[0]._replace(u=350.0)], HEIGHT)) == 2
