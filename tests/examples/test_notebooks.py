"""The notebooks: `make docs` runs them; here is what can be said without a kernel."""

import importlib
import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))


def cells_of(notebook: Path, kind: str) -> list[str]:
    cells = json.loads(notebook.read_text("utf-8"))["cells"]
    return ["".join(one["source"]) for one in cells if one["cell_type"] == kind]


def test_there_are_three():
    assert len(NOTEBOOKS) == 3


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda one: one.stem)
def test_a_notebook_holds_no_results_of_a_machine(notebook):
    for cell in json.loads(notebook.read_text("utf-8"))["cells"]:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda one: one.stem)
def test_a_notebook_uses_what_there_is(notebook, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    pages = importlib.import_module("page_commands")
    for cell in cells_of(notebook, "code"):
        shell = "\n".join(line[1:] for line in cell.splitlines() if line.startswith("!"))
        python = "\n".join(line for line in cell.splitlines() if line[:1] not in ("!", "%"))
        assert list(pages.command_faults(shell.replace("{one_house}", "houses-train"))) == []
        assert list(pages.python_faults(python)) == []
