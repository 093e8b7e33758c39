"""Tests of networks in this process. They need torch and are skipped where it is absent."""

import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

_HOW = (
    "needs torch and transformers: pip install torch==2.13.0 && pip install transformers "
    "accelerate && pip install --no-deps torchvision==0.28.0"
)
_HERE = Path(__file__).parent


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if _HERE in item.path.parents:
            # Their warnings are about themselves, not about us.
            item.add_marker(pytest.mark.filterwarnings("default"))


@pytest.fixture(scope="session", autouse=True)
def torch_or_skip() -> None:
    """Skip all of this folder without torch; quiet and offline with it."""
    torch = pytest.importorskip("torch", reason=_HOW)
    torch.set_num_threads(1)  # networks this small only wait for each other's threads
    os.environ["HF_HUB_OFFLINE"] = "1"
    from cpu_torchvision import prepare

    prepare()
    pytest.importorskip("transformers", reason=_HOW)


@pytest.fixture(scope="session", params=["cpu", "cuda"])
def device(torch_or_skip: None, request: pytest.FixtureRequest) -> str:
    """Each device of this machine; the GPU's tests are skipped where there is none."""
    import torch

    if request.param == "cuda" and not torch.cuda.is_available():
        pytest.skip("torch sees no GPU here")
    return request.param


@pytest.fixture(scope="session")
def tiny(torch_or_skip: None, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Builds a tiny model by name, once a session."""
    import tiny_models

    built: dict[str, Path] = {}

    def build(name: str) -> Path:
        if name not in built:
            built[name] = getattr(tiny_models, name)(tmp_path_factory.mktemp(name))
        return built[name]

    return build


@pytest.fixture(scope="session")
def transformers_server(
    tiny: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[str]:
    """``transformers serve`` with the tiny Qwen2.5-VL on the CPU; gives its spec."""
    model = tiny("qwen25_vl")
    cache = tmp_path_factory.mktemp("cache")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    log = (cache / "server.log").open("w")
    process = subprocess.Popen(
        [
            *(sys.executable, str(_HERE / "serve_transformers.py"), "serve", str(model)),
            *("--host", "127.0.0.1", "--port", str(port), "--device", "cpu"),
        ],
        stdout=log,
        stderr=subprocess.STDOUT,
        env={
            **os.environ,
            "HF_HUB_OFFLINE": "1",
            "HF_HUB_CACHE": str(cache),
            "OMP_NUM_THREADS": "1",
        },
    )
    try:
        _wait_for(f"http://127.0.0.1:{port}/health", process, cache / "server.log")
        yield f"openai:http://127.0.0.1:{port}/v1#{model}"
    finally:
        process.terminate()
        process.wait(timeout=20.0)
        log.close()


def _wait_for(url: str, process: subprocess.Popen, log: Path) -> None:
    end = time.monotonic() + 120.0
    while time.monotonic() < end and process.poll() is None:
        try:
            urllib.request.urlopen(url, timeout=2.0).close()
        except OSError:
            time.sleep(0.2)
        else:
            return
    pytest.fail(f"transformers serve did not start: {log.read_text()[-2000:]}")
