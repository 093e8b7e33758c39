"""A key doesn't show in a server's text, however it is escaped there."""

import base64
import html
import json
import time
import urllib.parse

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.io.secret import Secret

KEY = "sk-live/DEF+0=&1'\"<z\\Q"

SPELLINGS = {
    "as it is": KEY,
    "in JSON": json.dumps(KEY),
    "in JSON in JSON": json.dumps(json.dumps(KEY)),
    "in PHP's JSON": json.dumps(KEY).replace("/", r"\/"),
    "in JSON's code points": "".join(f"\\u{ord(one):04X}" for one in KEY),
    "in a URL": urllib.parse.quote(KEY, safe=""),
    "in a URL in a URL": urllib.parse.quote(urllib.parse.quote(KEY, safe=""), safe=""),
    "in HTML": html.escape(KEY),
    "in HTML's code points": "".join(f"&#x{ord(one):X};" for one in KEY),
}


@pytest.mark.parametrize("spelling", SPELLINGS.values(), ids=SPELLINGS)
def test_a_key_is_blanked_in_every_spelling(spelling):
    text = f"Bearer {spelling} was refused"
    said = Secret(KEY).blanked(text)
    assert "***" in said
    assert said.startswith("Bearer ")
    assert said.endswith(" was refused")
    assert "live" not in said
    assert "F+0" not in said
    assert Secret(KEY).blanked_bytes(text.encode()).decode() == said


@given(st.text(st.characters(codec="ascii", exclude_categories=["Cc"]), min_size=5), st.data())
def test_json_stays_json_and_loses_any_key(end, data):
    key = f"sk-{end}"
    before, after = data.draw(st.text()), data.draw(st.text())
    body = json.dumps({"content": before + key + after}).encode()
    said = json.loads(Secret(key).blanked_bytes(body))["content"]
    assert key not in said


@pytest.mark.parametrize("key", ["", "none", "EMPTY12"])
def test_a_placeholder_is_left_in_texts(key):
    assert Secret(key).blanked(f"none, EMPTY12, {key}") == f"none, EMPTY12, {key}"


def test_other_text_is_left_as_it_is():
    text = base64.b64encode(bytes(range(256))).decode()
    assert Secret(KEY).blanked(text) == text


@pytest.mark.parametrize("said", ["\\", "%25", "&amp;", "&#x000", KEY[:-1]])
def test_no_text_takes_long(said):
    text = said * (200_000 // len(said))
    begin = time.process_time()
    assert Secret(KEY).blanked(text) == text
    assert time.process_time() - begin < 5.0  # a search that goes back would take hours
