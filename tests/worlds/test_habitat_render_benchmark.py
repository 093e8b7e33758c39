import runpy
from pathlib import Path

import pytest
from rich.table import Table

import fake_habitat
from hypernav.worlds.scans.scan_loading import open_scene
from scan_writers.episodes import HASH, SCENE

SCRIPT = Path(__file__).parents[3] / "benchmarks" / "render.py"


@pytest.mark.slow
def test_habitat_draws_the_views_of_the_benchmark_beside_ours(
    benchmark_data: Path, monkeypatch: pytest.MonkeyPatch
):
    fake_habitat.install(monkeypatch)
    file = benchmark_data / "scene_datasets" / "hm3d" / "val" / SCENE / f"{HASH}.glb"
    benchmark = runpy.run_path(str(SCRIPT))
    scene, table = open_scene(file), Table("scene", "what", "median", "p95", "CPU")
    said = benchmark["measure_peer"](table, scene, file, benchmark["standing_views"](scene, 2))
    assert list(table.columns[1].cells) == [
        f"{who}: {what}"
        for what in ("render", "depth and instances")
        for who in ("habitat-sim", "beside it")
    ]
    assert "1 mm on 100.0000%" in said
    assert "instances equal on 100.0000%" in said
    assert "colours 0.00 of 255" in said
