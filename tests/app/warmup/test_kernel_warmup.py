import os
import subprocess
import sys
from types import SimpleNamespace

import pytest

from hypernav.app.warmup import background as module
from hypernav.app.warmup.background import FIRST_RUN, warm_up_in_background
from hypernav.app.warmup.exercises import warm_up
from hypernav.search.mapping import top_down_kernels

PYTHON = f"py{sys.version_info.major}{sys.version_info.minor}"
ENTER = (
    "from hypernav.app.warmup.background import is_compiled, warm_up_in_background\n"
    "print(is_compiled())\n"
    "with warm_up_in_background(print): pass"
)


def test_the_warm_up_runs_an_agent():
    warm_up()


def test_it_leaves_no_kernel_of_navigation_meshes_to_be_compiled():
    script = (
        "from numba.extending import is_jitted\n"
        "from hypernav.app.warmup.exercises import walk_on_mesh\n"
        "from hypernav.simulator.worlds.navmesh import navmesh\n"
        "walk_on_mesh()\n"
        "for kernel in vars(navmesh).values():\n"
        "    if is_jitted(kernel) and not kernel.signatures: print(kernel.__name__)"
    )
    ended = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert not ended.stdout.split()


@pytest.mark.slow
def test_a_first_search_compiles_no_kernel_of_the_warm_up_for_other_types(tmp_path):
    script = (
        "import sys\n"
        "from hypernav import find\n"
        "from hypernav.app.warmup.exercises import warm_up\n"
        "from numba.extending import is_jitted\n"
        "def compiled():\n"
        "    modules = [one for name, one in sys.modules.items() if name.startswith('hypernav')]\n"
        "    things = {id(one): one for module in modules for one in vars(module).values()}\n"
        "    kernels = filter(is_jitted, things.values())\n"
        "    return {one: set(one.signatures) for one in kernels if one.signatures}\n"
        "warm_up()\n"
        "before = compiled()\n"
        "for _ in find('bed', seed=2): pass\n"
        "after = compiled()\n"
        "print(len(before), *[one.__name__ for one in before if after[one] != before[one]])\n"
        "print(*[one.__name__ for one in after if one not in before])"
    )
    environment = {**os.environ, "HYPERNAV_CACHE": str(tmp_path)}  # the house is made anew
    ended = subprocess.run(
        [sys.executable, "-c", script],
        env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    warm, own = ended.stdout.splitlines()
    number, *again = warm.split()
    assert int(number) > 20
    assert again == []
    # What finds the floors of a scene is compiled meanwhile, by the program that waits.
    assert set(own.split()) == {"rasterise", "floors_of_columns", "mark_cliffs"}


def test_a_machine_that_has_compiled_is_told_nothing_and_starts_no_process(monkeypatch):
    monkeypatch.setattr(module, "is_compiled", lambda: True)
    monkeypatch.setattr(subprocess, "Popen", None)
    said = []
    with warm_up_in_background(said.append):
        pass
    assert said == []


def test_an_empty_cache_is_a_first_run_and_leaves_no_process(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    ended = subprocess.run(
        [sys.executable, "-c", ENTER],
        env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert ended.stdout.splitlines() == ["False", FIRST_RUN]


def test_an_error_ends_the_warm_up(monkeypatch):
    started = []

    class Noted(subprocess.Popen):
        def __init__(self, *arguments, **options):
            super().__init__(*arguments, **options)
            started.append(self)

    monkeypatch.setattr(module, "is_compiled", lambda: False)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    monkeypatch.setattr(subprocess, "Popen", Noted)
    with pytest.raises(KeyboardInterrupt), warm_up_in_background(lambda words: None):
        raise KeyboardInterrupt
    assert [process.poll() is not None for process in started] == [True]


@pytest.mark.parametrize(
    ("python", "age_s", "counts"),
    [(PYTHON, 60, True), ("py39", 60, False),
     (PYTHON, -60, False)],
    ids=["of this source", "of another Python", "of an older source"],
)  # fmt: skip
def test_only_what_was_compiled_of_this_source_by_this_python_counts(
    tmp_path, monkeypatch, python, age_s, counts
):
    kernel = SimpleNamespace(
        __name__="integrate_frame", stats=SimpleNamespace(cache_path=str(tmp_path))
    )
    monkeypatch.setattr(top_down_kernels, "integrate_frame", kernel)
    monkeypatch.setattr(module, "is_jitted", lambda kernel: True)
    index = tmp_path / f"top_down_kernels.integrate_frame-260.{python}.nbi"
    index.touch()
    changed = os.stat(top_down_kernels.__file__).st_mtime
    os.utime(index, (changed + age_s, changed + age_s))
    assert module.is_compiled() == counts


def test_without_compiling_there_is_no_first_run(tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "NUMBA_DISABLE_JIT": "1"}
    ended = subprocess.run(
        [sys.executable, "-c", ENTER],
        env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert ended.stdout.splitlines() == ["True"]
