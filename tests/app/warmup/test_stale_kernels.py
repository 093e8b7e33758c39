"""What was compiled before a kernel's source changed is forgotten."""

import os
from pathlib import Path

from hypernav.app.warmup.stale_kernels import forget_stale_kernels


def test_a_kernel_is_forgotten_when_a_file_changes_that_it_may_call(tmp_path: Path):
    cache = tmp_path / "room" / "__pycache__"
    cache.mkdir(parents=True)
    sources = [tmp_path / "room" / name for name in ("map_kernels.py", "drop_kernels.py")]
    index = cache / "map_kernels.integrate-1.py311.nbi"
    for path, age in ((sources[0], 30), (sources[1], 20), (index, 10)):
        path.touch()
        os.utime(path, (1_000_000 - age, 1_000_000 - age))
    forget_stale_kernels(tmp_path)
    assert index.exists()
    os.utime(sources[1], (1_000_000, 1_000_000))
    forget_stale_kernels(tmp_path)
    assert not index.exists()


def test_a_package_without_kernels_is_left_alone(tmp_path: Path):
    forget_stale_kernels(tmp_path)
