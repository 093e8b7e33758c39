import pytest

from hypernav.app.show.templating import page_environment

EVIL = "\x1b[31m \u202e <b>"


@pytest.mark.parametrize(
    ("template", "shown"),
    [
        ("{{ text }}", r"\x1b[31m \u202e &lt;b&gt;"),
        ("{{ text | upper }}", r"\x1b[31M \u202e &lt;B&gt;"),
        ("{{ text | safe }}", r"\x1b[31m \u202e <b>"),
        ("<p title='{{ text }}'>", r"<p title='\x1b[31m \u202e &lt;b&gt;'>"),
        ("{{ {'a': [text]} | tojson }}", r'{"a": ["\\x1b[31m \\u202e \u003cb\u003e"]}'),
        ("{{ 7 }}{{ none }}", "7None"),
    ],
)
def test_what_a_browser_obeys_is_shown(template: str, shown: str):
    assert page_environment().from_string(template).render(text=EVIL) == shown
