import json

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from hypernav.io.parsing import (
    MOST_CHARACTERS,
    MOST_LEVELS,
    check_json_size,
    parse_json,
    parse_xml,
    parse_yaml,
)
from hypernav.io.reading import Allowance

VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**12), 10**12)
    | st.floats(allow_nan=False)
    | st.text("abc"),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text("abc"), inner, max_size=4),
    max_leaves=20,
)


@given(VALUES)
def test_plain_values_survive(value):
    assert parse_yaml(yaml.safe_dump(value)) == value


@given(VALUES.filter(lambda value: "inf" not in repr(value)))
def test_json_survives(value):
    assert parse_json(json.dumps(value).encode()) == value


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\nb: 2\na: 3", "the key 'a' is there twice"),
        ("{a: 1, 'a': 2}", "the key 'a' is there twice"),
        ("a: {b: 1, b: 1}", "the key 'b' is there twice"),
        ("a: &x [1]\nb: [*x, *x]", "aliases"),
        ("!!python/object:os.system x", "tags"),
        ("a: !!int ''", "tags"),
        ("[" * 100_000, f"more than {MOST_LEVELS} levels"),
        ("- " * 50_000, f"more than {MOST_LEVELS} levels"),
        ("x" * (MOST_CHARACTERS + 1), "200,001 characters, at most 200,000"),
        ("a: " + "9" * 5000, "at most 40 digits"),
        ("a: 0x" + "f" * 9000, "at most 40 digits"),
        ("a: 2001-99-99", "a value is impossible"),
        ("a: 0x_", "a value is impossible"),
        ("a: =", "could not determine"),
        (r'"a\ud800": 1', "surrogates"),
        (r'a: {b: ["\ud800"]}', "surrogates"),
    ],
)
def test_yaml_that_means_too_much_or_nothing_is_refused(text, words):
    with pytest.raises(yaml.YAMLError, match=words):
        parse_yaml(text)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"[NaN]", "NaN is not a number of JSON"),
        (b'{"a": -Infinity}', "Infinity is not a number of JSON"),
        (b"[" * 200_000, "nested too deeply"),
        (b'{"a":' * 100_000, "nested too deeply"),
        (b'["\\ud800"]', "surrogates"),
        (b"9" * 5000, "digits"),
        (b"\x80abc", "decode"),
        (b"", "Expecting value"),
    ],
)
def test_what_is_no_json_is_refused(text, words):
    with pytest.raises(ValueError, match=words):
        parse_json(text)


def test_whole_characters_in_two_halves_are_read():
    assert parse_json(b'"\\ud83d\\ude00"') == "\U0001f600"


def test_the_memory_of_values_is_counted_before_they_are_parsed():
    check_json_size(b"[" + b"0.5," * 3_000_000 + b"0]", Allowance())
    text = b"[" + b'{"a":[1,2]},' * 3_000_000 + b"0]"
    with pytest.raises(OSError, match=r"what its JSON says would take 2,322 MB, .* 2,000 MB"):
        check_json_size(text, Allowance())


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_xml_that_defines_entities_is_refused_and_any_other_is_read_without_namespaces(encoding):
    plain = f'\n<?xml version="1.0" encoding="{encoding}"?><a xmlns="urn:x"><b c="&lt;"/></a>'
    root = parse_xml(plain.strip().encode(encoding), Allowance())
    assert [one.tag for one in root.iter()] == ["a", "b"]
    assert root[0].attrib == {"c": "<"}
    bomb = plain.strip().replace("<a ", '<!DOCTYPE a [<!ENTITY e "x">]><a ')
    with pytest.raises(ValueError, match="defines entities"):
        parse_xml(bomb.encode(encoding), Allowance())


@pytest.mark.parametrize(
    "text", [b"", b"<a>", b"<a></b>", b'<?xml version="1.0" encoding="x"?><a/>']
)
def test_what_is_no_xml_is_refused(text: bytes):
    with pytest.raises(ValueError, match="not well-formed XML"):
        parse_xml(text, Allowance())


def test_white_space_before_xml_is_no_fault_and_its_elements_are_counted():
    assert parse_xml(b" \n<a/>", Allowance()).tag == "a"
    with pytest.raises(OSError, match="its elements would take"):
        parse_xml(b"<a>" + b"<b/>" * 8_000_000 + b"</a>", Allowance())
