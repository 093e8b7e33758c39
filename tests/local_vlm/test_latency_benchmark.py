import runpy
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "benchmarks" / "vlm_latency.py"


def test_the_benchmark_runs_with_a_tiny_model_on_the_cpu(capsys: pytest.CaptureFixture[str]):
    benchmark = runpy.run_path(str(SCRIPT))
    benchmark["main"](size="tiny", device="cpu", batches=(1, 2), rounds=1)
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[:-3] for row in rows] == [["grounding"]] * 2 + [["block", "choice"]] * 2
    assert all(float(row[-1]) > 0.0 for row in rows)


def test_its_prompts_have_the_length_of_the_real_ones(tiny, torch_or_skip: None):
    """Text apart: 391 tokens for the camera's image, 729 for the map."""
    benchmark = runpy.run_path(str(SCRIPT))
    import torch

    lengths = []
    for task in benchmark["TASKS"]:
        inputs = benchmark["inputs_for"](task, 1, torch.device("cpu"), torch.float32)
        lengths.append(int((inputs["input_ids"] == benchmark["IMAGE_PAD"]).sum()))
    assert lengths == [391, 729]
