"""How many small faults in what the robot runs would a test notice?

Draws mutants of the seven rooms that run on the robot (one comparison, sign, number, condition or
loop changed), by the operators of cosmic-ray, and runs for each the tests that mirror its module:
``search/mapping/memory/floor.py`` has ``tests/search/mapping/memory/test_floor.py``, and the rest
of that folder if this file is absent or passes. Mutants are made in a copy; the checkout is only
read. A line of JSON about each is appended to ``--out``, and ones that it already holds are not run
again.

Run: make mutants, or python scripts/mutants.py --seed 1 --count 300 --minutes 30 --out FILE
"""

import argparse
import difflib
import hashlib
import heapq
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator

ROOT = Path(__file__).parents[1]
ROOMS = ("core", "io", "search")
OPERATORS = tuple(
    f"core/{name}"
    for name in (
        *("ReplaceComparisonOperator_Lt_LtE", "ReplaceComparisonOperator_LtE_Lt"),
        *("ReplaceComparisonOperator_Gt_GtE", "ReplaceComparisonOperator_GtE_Gt"),
        *("ReplaceComparisonOperator_Eq_NotEq", "ReplaceComparisonOperator_NotEq_Eq"),
        *("ReplaceComparisonOperator_Is_IsNot", "ReplaceComparisonOperator_IsNot_Is"),
        *("ReplaceBinaryOperator_Add_Sub", "ReplaceBinaryOperator_Sub_Add"),
        *("ReplaceBinaryOperator_Mul_Div", "ReplaceBinaryOperator_Div_Mul"),
        *("ReplaceUnaryOperator_Delete_USub", "ReplaceUnaryOperator_Delete_Not", "AddNot"),
        *("ReplaceTrueWithFalse", "ReplaceFalseWithTrue", "NumberReplacer"),
        *("ReplaceAndWithOr", "ReplaceOrWithAnd"),
        *("ReplaceBreakWithContinue", "ReplaceContinueWithBreak", "ZeroIterationForLoop"),
    )
)
"""Operators whose mutants are faults that somebody might make; none changes types or `njit`."""
_MOST_S = 240.0
"""Time for the tests of one mutant; those of a changed kernel compile all that they call."""


_FAST = ("-m", "not slow and not freeze")


@dataclass(frozen=True)
class Mutant:
    """One small change: which operator, at which of its places in a module."""

    module: str
    operator: str
    occurrence: int

    def lot(self, seed: int) -> bytes:
        """Whether it is drawn depends on itself alone, so that a sample outlives other changes."""
        return hashlib.sha256(f"{seed} {self}".encode()).digest()


def main() -> None:
    """Draw mutants, run their tests and print what survives."""
    parser = argparse.ArgumentParser(description="Run the tests against small faults.")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=300, help="number of mutants to draw")
    parser.add_argument("--minutes", type=float, default=30.0, help="no new one begins later")
    parser.add_argument("--python", default=sys.executable, help="the one that runs the tests")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "mutants.jsonl")
    chosen = parser.parse_args()
    every = list(mutants())
    drawn = heapq.nsmallest(chosen.count, every, key=lambda one: one.lot(chosen.seed))
    chosen.out.parent.mkdir(parents=True, exist_ok=True)
    lines = chosen.out.read_text("utf-8").splitlines() if chosen.out.is_file() else []
    done = {Mutant(**entry["mutant"]): entry for entry in map(json.loads, lines)}
    until = time.monotonic() + chosen.minutes * 60.0
    with tempfile.TemporaryDirectory() as folder, chosen.out.open("a", encoding="utf-8") as file:
        copy = _copied(Path(folder))
        for number, mutant in enumerate(drawn, start=1):
            if mutant in done:
                continue
            if time.monotonic() > until:
                break
            entry = _tried(mutant, copy, chosen.python)
            done[mutant] = entry
            print(json.dumps(entry), file=file, flush=True)
            what = f"{mutant.module} {mutant.operator.partition('/')[2]}"
            print(f"{number}/{len(drawn)} {entry['fate']} {what}", flush=True)
    _report([done[one] for one in drawn if one in done], len(drawn), len(every))


def mutants() -> Iterator[Mutant]:
    """All mutants of the seven rooms."""
    for path in sorted(path for room in ROOMS for path in _package(ROOT, room).rglob("*.py")):
        nodes = list(ast_nodes(get_ast_from_path(path)))
        module = path.relative_to(ROOT / "src").as_posix()
        for name in OPERATORS:
            operator = get_operator(name)()
            places = sum(len(list(operator.mutation_positions(node))) for node in nodes)
            yield from (Mutant(module, name, k) for k in range(places))


def tests_of(module: str) -> list[list[Path]]:
    """The tests that belong to a module, in the order in which they are run, from the narrowest."""
    path = Path(module).relative_to("hypernav")
    own = ROOT / "tests" / path.parent / f"test_{path.stem}.py"
    folder = own.parent
    while not folder.is_dir() or not any(folder.glob("test_*.py")):
        folder = folder.parent
    others = [one for one in sorted(folder.glob("test_*.py")) if one != own]
    return [tests for tests in ([own] if own.is_file() else [], others) if tests]


def _package(root: Path, room: str) -> Path:
    return root / "src" / "hypernav" / room


def _copied(folder: Path) -> Path:
    """A copy of the package and its tests with what Numba has compiled for them."""
    for name in ("src", "tests", "docs", "examples"):
        shutil.copytree(ROOT / name, folder / name, symlinks=True)
    shutil.copy2(ROOT / "pyproject.toml", folder)
    return folder


def _tried(mutant: Mutant, copy: Path, python: str) -> dict[str, object]:
    """What becomes of a mutant."""
    path = copy / "src" / mutant.module
    code, times = path.read_text("utf-8"), os.stat(path)
    changed = mutate_code(code, get_operator(mutant.operator)(), mutant.occurrence)
    assert changed is not None, mutant
    diff = [*difflib.unified_diff(code.splitlines(), changed.splitlines(), lineterm="", n=2)][2:]
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as kernels:
        # With the time of before nothing that is compiled counts as outdated; only the bytecode of
        # this module goes. What calls a kernel has it inside, so that is compiled elsewhere.
        environment = {"NUMBA_CACHE_DIR": kernels} if path.stem.endswith("_kernels") else {}
        _write(path, changed, times)
        try:
            fate = _fate(tests_of(mutant.module), copy, python, environment)
        finally:
            _write(path, code, times)
    took_s = round(time.monotonic() - began, 1)
    return {"mutant": asdict(mutant), "fate": fate, "seconds": took_s, "diff": diff}


def _write(path: Path, code: str, times: os.stat_result) -> None:
    path.write_text(code, "utf-8")
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    for bytecode in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
        bytecode.unlink()


def _fate(
    stages: Sequence[Sequence[Path]], copy: Path, python: str, more: Mapping[str, str]
) -> str:
    """Whether tests notice what has been changed in a copy."""
    data = os.environ.get("HYPERNAV_TEST_DATA", str(ROOT.parent / "shared" / "data"))
    environment = os.environ | {
        "PYTHONPATH": str(copy / "src"),
        "PYTHONDONTWRITEBYTECODE": "1",
        "HYPERNAV_TEST_DATA": data,
        **more,
    }
    limit = time.monotonic() + _MOST_S
    for tests in stages:
        names = [str(copy / path.relative_to(ROOT)) for path in tests]
        try:
            done = subprocess.run(
                [*(python, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"), *_FAST, *names],
                cwd=copy,
                env=environment,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                check=False,
                timeout=max(limit - time.monotonic(), 1.0),
            )
        except subprocess.TimeoutExpired:
            return "out of time"
        if done.returncode not in (0, 5):  # 5: all of them are slow
            return "killed"
    return "survived"


def _report(entries: Sequence[dict[str, object]], drawn: int, every: int) -> None:
    fates = Counter(entry["fate"] for entry in entries)
    for entry in entries:
        if entry["fate"] == "survived":
            print(f"\n{entry['mutant']}", *entry["diff"], sep="\n")  # type: ignore[misc]
    judged = fates["killed"] + fates["survived"]
    share = f"{fates['killed'] / judged:.1%}" if judged else "none"
    print(f"\n{dict(fates)}: {share} of {judged} killed; {drawn} drawn of {every}")


if __name__ == "__main__":
    main()
