import runpy
from collections.abc import Callable
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


def test_the_benchmark_runs_with_a_tiny_model(device: str, capsys: pytest.CaptureFixture[str]):
    benchmark = runpy.run_path(str(BENCHMARKS / "vlm_latency.py"))
    benchmark["main"](size="tiny", device=device, rounds=1)
    said = capsys.readouterr().out.splitlines()
    tasks = benchmark["tasks"]()
    rows = {
        task.name: line.split() for task in tasks for line in said if line.startswith(task.name)
    }
    assert list(rows) == [task.name for task in tasks]
    tokens_out = {name: int(row[-5]) for name, row in rows.items()}
    for task in tasks:
        expected = 1 if task.question.allowed else task.question.max_tokens
        assert tokens_out[task.name] == expected
    tokens_in = {name: int(row[-6]) for name, row in rows.items()}
    # 391 tokens for the camera's image, 729 for the map; the rest is text.
    assert 0 < tokens_in["boxes: one"] - 391 < 150
    assert 0 < tokens_in["block, reasoned"] - 729 < 800


@pytest.mark.parametrize(("name", "network"), [("sam: tiny", "sam"), ("zero-shot: tiny", "owlv2")])
def test_the_benchmark_of_detectors_and_segmenters_times_them(
    device: str, tiny: Callable[[str], Path], name: str, network: str
):
    benchmark = runpy.run_path(str(BENCHMARKS / "vision_latency.py"))
    look = benchmark["opened"](name, str(tiny(network)), device, "float32")
    assert benchmark["median_ms"](look, benchmark["camera_view"](), 1) > 0.0
