from hypernav.core.naming.words import number_of


def test_one_is_singular_and_all_else_plural():
    assert [number_of(count, "thing") for count in (0, 1, 1200)] == [
        "0 things",
        "1 thing",
        "1,200 things",
    ]
    assert number_of(2, "search", "searches") == "2 searches"
