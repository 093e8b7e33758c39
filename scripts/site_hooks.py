"""What the site shows that no page holds: examples, and tables of results with their sources."""

import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files
from result_tables import Results

_ROOT = Path(__file__).parents[1]
_SPOKEN = {
    'data-md-component="search" role="dialog"': (
        'data-md-component="search" role="dialog" aria-label="Search"'
    ),
    "<th></th>": "<td></td>",
}
"""What the theme leaves without a name, and what is put there."""
_EXAMPLE = re.compile(r"\]\(((?:\.\./)+)(?=examples/)")


def on_files(files: Files, config: Any) -> Files:
    """Put the examples beside the pages, so that links to them lead somewhere."""
    for path in sorted((_ROOT / "examples").glob("*.py")):
        name = f"examples/{path.name}"
        files.append(File.generated(config, name, content=path.read_text("utf-8")))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put in tables, and lead links out of ``docs/`` to the copies of the examples."""
    markdown = Results().page(markdown)
    return _EXAMPLE.sub(lambda link: f"]({link[1].removeprefix('../')}", markdown)


def on_post_page(output: str, **_: Any) -> str:
    """Name for screen readers what the theme does not."""
    for said, spoken in _SPOKEN.items():
        output = output.replace(said, spoken)
    return output
