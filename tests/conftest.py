"""Fixtures for all tests. Array shapes and types are checked at run time here, and only here."""

import gc
import os
from collections.abc import Generator
from pathlib import Path

# More processes than cores run tests: threads of BLAS would only wait for each other, busily.
# Before the first import of NumPy, which reads it; processes that tests start inherit it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import settings

from kernel_cache import compile_missing_kernels
from runtime_checks import check_modules

_SOURCE = Path(__file__).parents[1] / "src"
_COMPILED = ("kernels.py", "core/geometry/depth.py")
_DDS = "robot/ros2/"


def _checked_modules() -> list[str]:
    """All modules that a run-time checker can wrap.

    It can't wrap what numba compiles, and beartype refuses the message types of cyclonedds.
    """
    return [
        ".".join(path.relative_to(_SOURCE).with_suffix("").parts)
        for path in sorted((_SOURCE / "hypernav").rglob("*.py"))
        if path.name != "__init__.py"
        and not path.as_posix().endswith(_COMPILED)
        and _DDS not in path.as_posix()
    ]


# Speed is measured in benchmarks/, never asserted in a test.
settings.register_profile("hypernav", deadline=None)
settings.load_profile("hypernav")

check_modules(_checked_modules())


def pytest_configure(config: pytest.Config) -> None:
    from hypernav.app.warmup.stale_kernels import forget_stale_kernels  # After the hook above.

    if not hasattr(config, "workerinput"):
        forget_stale_kernels()
    if config.getoption(
        "numprocesses", None
    ):  # not in a worker, and not where there is one process
        compile_missing_kernels()


@pytest.hookimpl(wrapper=True, optionalhook=True)
def pytest_xdist_auto_num_workers(config: pytest.Config) -> Generator[None, int, int]:
    """One process more than cores: some tests wait, for a moment to pass or for the network.

    Slow tests do so while other processes have to keep pace.
    """
    cores = yield
    return cores if config.getoption("markexpr") == "slow" else cores + 1


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Spare the search for garbage what is imported: it took a tenth of the time of the tests."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture(scope="session")
def test_data() -> Path:
    """The folder of real test data; tests that need it are skipped where it is absent."""
    default = Path(__file__).parents[2] / "shared" / "data"
    path = Path(os.environ.get("HYPERNAV_TEST_DATA", default))
    if not path.is_dir():
        pytest.skip(f"no test data in {path}; set HYPERNAV_TEST_DATA to the folder that holds it")
    return path


@pytest.fixture(scope="session")
def benchmark_data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small data folder with every benchmark, to be read; tests that change it take a copy."""
    from scan_writers.data_folder import write_data  # After the hook above.

    return write_data(tmp_path_factory.mktemp("benchmarks") / "data")


@pytest.fixture(scope="session")
def small_house(test_data: Path) -> Path:
    """The GLB of a real furnished house."""
    return test_data / "scenes" / "small_house" / "scene.glb"
