import pytest

from hypernav.core.naming.labels import other_names


@pytest.mark.parametrize(
    ("a", "b"),
    [("stove", "range"), ("bath", "bathtub"), ("curtain", "drape")],
)
def test_what_one_calls_by_another_name_is_called_so_the_other_way_too(a: str, b: str):
    assert b in other_names(a)
    assert a in other_names(b)


def test_a_wider_word_names_its_kinds_and_none_of_them_names_the_rest():
    assert "potted plant" in other_names("cactus")
    assert "cactus" not in other_names("potted plant")
    assert "fern" not in other_names("cactus")
