import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from hypernav.core.components.registry import Choice, Entry, Registry, import_target
from hypernav.core.errors import ComponentError, ConfigError, ImportTargetError


@pytest.fixture
def shapes() -> Registry[Callable[..., object]]:
    return Registry(
        "shape",
        "hypernav.test_shapes",
        [
            Entry("point", "math:hypot", section="points"),
            Entry("circle", abs, form="circle:RADIUS", words="a circle ({files})"),
            Entry("box", min, form="box:WIDTH,HEIGHT"),
        ],
    )


@pytest.fixture
def own_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a module ``odd_shapes`` in it, where the user stands."""
    (tmp_path / "odd_shapes.py").write_text("class Star:\n    pass\n")
    (tmp_path / "broken_shapes.py").write_text("import no_such_package_at_all\n")
    (tmp_path / "older_shapes.py").write_text("from math import no_such_function\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry])
    yield tmp_path
    for name in ("odd_shapes", "broken_shapes", "older_shapes"):
        sys.modules.pop(name, None)


def test_a_name_leads_to_what_was_registered(shapes: Registry):
    choice = shapes.find("circle:2.5")
    assert choice.load() is abs
    assert choice.arguments == ("2.5",)


def test_a_target_is_imported_when_it_is_wanted():
    program = (
        "import sys; from hypernav.core.components.registry import *;"
        "shapes = Registry('shape', 'hypernav.test_shapes', [Entry('point', 'wave:open')]);"
        "choice = shapes.find('point'); assert 'wave' not in sys.modules;"
        "choice.load(); assert 'wave' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


def test_the_form_says_how_many_arguments_follow(shapes: Registry):
    assert shapes.find("box:1,2").arguments == ("1", "2")
    assert shapes.find("circle:a,b.onnx").arguments == ("a,b.onnx",)
    assert shapes.find("point").arguments == ()


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("circle:", "shape 'circle:': expected circle:RADIUS"),
        ("circle", "shape 'circle': expected circle:RADIUS"),
        ("box:1", "shape 'box:1': expected box:WIDTH,HEIGHT"),
        ("box:1,", "shape 'box:1,': expected box:WIDTH,HEIGHT"),
        ("point:3", "shape 'point:3': nothing follows this name; write point"),
        ("cirkle", "unknown shape 'cirkle'; did you mean 'circle'? use point, circle:RADIUS, box:"),
        ("", "unknown shape ''; use point"),
        ("boxx:1,2", "unknown shape 'boxx:1,2'; did you mean 'box'?"),
    ],
)
def test_what_is_not_understood_names_the_remedy(shapes: Registry, spec: str, words: str):
    with pytest.raises(ConfigError) as caught:
        shapes.find(spec)
    assert words in str(caught.value)


def test_words_name_files_without_their_folders(shapes: Registry):
    assert shapes.find("circle:/a/b/net.onnx").words() == "a circle (net.onnx)"
    assert shapes.find("point").words() == "point"
    assert shapes.find("box:a/1.onnx,b/2.onnx").words() == "box 1.onnx + 2.onnx"
    assert Choice(Entry("vlm", abs, words="{model}")).words(model="qwen") == "qwen"


def test_a_name_is_registered_once(shapes: Registry):
    shapes.add(Entry("line", max))
    assert shapes.find("line").load() is max
    with pytest.raises(ConfigError, match="there is a shape 'line' already"):
        shapes.add(Entry("line", min))


def test_a_thing_of_ones_own_is_named_by_where_it_is(shapes: Registry, own_module: Path):
    choice = shapes.find("odd_shapes:Star:big")
    assert choice.load().__name__ == "Star"
    assert choice.arguments == ("big",)
    assert choice.entry.is_foreign
    assert shapes.find("odd_shapes:Star").words() == "Star of odd_shapes"


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ("nowhere.at_all:Star", "there is no module 'nowhere'; run this in its folder"),
        ("odd_shapes.inner:Star", "there is no module 'odd_shapes.inner'"),
        ("odd_shapes:Stra", "has no 'Stra', but 'Star'"),
        ("broken_shapes:Star", "needs the module 'no_such_package_at_all', which is not installed"),
        ("older_shapes:Star", "older_shapes cannot be imported: cannot import name"),
        ("odd_shapes.py:Star", "there is no module 'odd_shapes.py'; leave out .py"),
        ("circlee:Star", "there is no module 'circlee'; run this in its folder"),
        ("circlee:Star", "did you mean 'circle'?"),
    ],
)
def test_what_cannot_be_imported_says_why(
    shapes: Registry, own_module: Path, spec: str, words: str
):
    with pytest.raises(ImportTargetError) as caught:
        shapes.find(spec)
    assert words in str(caught.value)


def test_an_installed_package_brings_things(
    shapes: Registry, own_module: Path, monkeypatch: pytest.MonkeyPatch
):
    info = own_module / "odd_shapes-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: odd-shapes\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[hypernav.test_shapes]\nstar = odd_shapes:Star\n")
    monkeypatch.syspath_prepend(own_module)
    assert shapes.knows("star")
    assert not shapes.knows("sun")
    choice = shapes.find("star:big")
    assert choice.load().__name__ == "Star"
    assert choice.words() == "star big"
    with pytest.raises(ConfigError, match=r"did you mean 'star'\? use .*, star or one of your own"):
        shapes.find("starr")


def test_an_import_target_is_the_thing_itself():
    assert import_target("math:pi") == pytest.approx(3.14159, abs=1e-5)


@pytest.mark.parametrize("line", ["1 / 0", "import sys; sys.exit(0)", "not Python"])
def test_a_module_that_fails_while_it_is_imported_is_named(line, tmp_path, monkeypatch):
    (tmp_path / "fails_at_once.py").write_text(line)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(
        ComponentError, match=r"fails_at_once:Thing: its import (raised|ended)"
    ) as it:
        import_target("fails_at_once:Thing")
    assert str(it.value).endswith(f", {tmp_path / 'fails_at_once.py'} line 1)")


def test_a_folder_that_is_gone_is_no_place_to_import_from(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    with pytest.raises(ImportTargetError, match="there is no module 'nowhere'"):
        Registry("detector", "").find("nowhere:Thing")


def test_several_are_joined_by_a_plus_where_they_can_be_used_together(shapes: Registry):
    with pytest.raises(ConfigError, match="point\\+circle"):
        shapes.find("point+circle:2")
    entries = [shapes.find(name).entry for name in ("point", "circle:1", "box:1,2")]
    both = Registry("shape", "", entries, together=Entry("together", "builtins:max"))
    choice = both.find("circle:2+box:1,2")
    assert [one.spec for one in choice.parts] == ["circle:2", "box:1,2"]
    assert choice.spec == "circle:2+box:1,2"
    assert choice.arguments == ("2", "1", "2")
    assert choice.words() == "a circle (2) + box 1 + 2"
    assert choice.load() is max
    assert both.find("circle:a+b.onnx").arguments == ("a+b.onnx",)  # of a file's name
    with pytest.raises(ConfigError, match="names one twice"):
        both.find("circle:2+circle:2")
