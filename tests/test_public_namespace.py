"""The public namespace: what it holds, that it is lazy, and that users need nothing deeper."""

import ast
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

import hypernav

ROOT = Path(__file__).parents[1]
DEEPER = re.compile(r"^\s*(?:from|import) (hypernav\.(?!envs\b)[\w.]+)", re.MULTILINE)
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)


def typed_imports() -> dict[str, str]:
    """The module of every name that a type checker sees."""
    tree = ast.parse(Path(hypernav.__file__).read_text(encoding="utf-8"))
    return {
        alias.name: str(node.module)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("hypernav.")
        for alias in node.names
    }


def test_a_type_checker_sees_the_names_that_are_loaded():
    assert typed_imports() == hypernav._MODULES
    assert hypernav.__all__ == sorted(hypernav._MODULES)


@pytest.mark.parametrize("name", hypernav.__all__)
def test_a_name_is_the_object_of_its_module(name):
    public = getattr(hypernav, name)
    assert public is getattr(importlib.import_module(hypernav._MODULES[name]), name)
    assert public.__module__ == hypernav._MODULES[name]
    assert public.__doc__


def test_the_names_are_offered_for_completion():
    assert set(hypernav.__all__) <= set(dir(hypernav))


def test_a_name_loads_no_more_than_its_module_needs():
    program = "import sys, hypernav; hypernav.Goal; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.split() == ["False"]


def programs() -> dict[str, str]:
    """Every program that users read."""
    pages = {path: BLOCK.findall(path.read_text("utf-8")) for path in ROOT.glob("docs/**/*.md")}
    pages[ROOT / "README.md"] = BLOCK.findall((ROOT / "README.md").read_text("utf-8"))
    found = {str(path.relative_to(ROOT)): "\n".join(blocks) for path, blocks in pages.items()}
    for path in ROOT.glob("examples/*.py"):
        found[str(path.relative_to(ROOT))] = path.read_text("utf-8")
    return {name: text for name, text in found.items() if text}


@pytest.mark.parametrize(("name", "program"), programs().items(), ids=programs())
def test_a_program_for_users_imports_nothing_deeper(name, program):
    assert not DEEPER.findall(program)
    used = set(re.findall(r"\bhypernav\.([A-Za-z]\w*)", program))
    assert used <= set(hypernav.__all__) | {"app", "envs"}


def test_a_deeper_import_would_be_noticed():
    assert DEEPER.findall("import hypernav.app.build\n  from hypernav.core.goal import Goal") == [
        "hypernav.app.build",
        "hypernav.core.goal",
    ]
    assert len(programs()) > 6
