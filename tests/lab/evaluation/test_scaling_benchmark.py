import importlib.util
import sys
from pathlib import Path

import pytest

from certainty import certain
from eval_runs import write_room

SCRIPT = Path(__file__).parents[3] / "benchmarks" / "eval_scaling.py"


@pytest.fixture(scope="module")
def benchmark():
    specification = certain(importlib.util.spec_from_file_location("eval_scaling", SCRIPT))
    module = importlib.util.module_from_spec(specification)
    sys.modules["eval_scaling"] = module
    certain(specification.loader).exec_module(module)
    yield module
    del sys.modules["eval_scaling"]


def test_the_busy_share_by_hand(benchmark):
    server = benchmark.ModelServer(capacity=2)
    with server:
        # One client asks from 0 s, two from 1 s; one slot works from 0 s, both from 2 to 3 s.
        server._changes = [(0.0, 1, 1), (1.0, 1, 2), (2.0, 2, 2), (3.0, 1, 2), (9.0, 0, 0)]
        assert server.busy_share(clients=2, until=5.0) == pytest.approx((1 + 2 + 1 + 1) / 8)
        assert server.busy_share(clients=3, until=5.0) == 0.0


@pytest.mark.slow
def test_16_episodes_keep_a_model_server_busy(benchmark, tmp_path, capsys):
    room = write_room(tmp_path / "room.glb")
    share = benchmark.server(
        workers=16, dataset=f"scene:{room}#24", episodes=48, max_steps=15, small=True
    )
    assert share >= 0.9
    assert "16 episodes at a time" in capsys.readouterr().out
