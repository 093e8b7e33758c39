"""How many small faults in what the robot runs would a test notice?

Draws mutants of the districts that run on the robot (one comparison, sign, number, condition or
loop changed), by the operators of cosmic-ray, and runs for each the tests that execute its line,
cheapest first, until one fails: those of the file that mirrors the module
(``tests/search/memory/test_floor.py`` for ``search/memory/floor.py``), then those of its
folder, then, with ``--far``, all of these rooms. Which lines a test executes and how long it takes
is recorded under ``build/`` when it is first asked for, and anew when the package or its file
changes.

One process imports everything and forks for each mutant, to exchange the code of the one function
that differs. A kernel that differs, and its callers, run without Numba there. Where what differs is
outside of functions (a default, a constant), another fork imports the package. The checkout is
only read. A line of JSON about each mutant is appended to ``--out``, and none is run again.

Run: make mutants, or python scripts/mutants.py --seed 1 --count 300 --minutes 30 --out FILE
"""

import argparse
import ast
import difflib
import gc
import hashlib
import heapq
import importlib
import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cached_property, partial
from importlib.machinery import SourceFileLoader
from inspect import CO_OPTIMIZED
from itertools import accumulate, pairwise
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any, Literal

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # a process that forks must have no threads

import coverage
import numba
import pytest
from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator
from numba.core.dispatcher import Dispatcher

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src"
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
_TESTS_S = 20.0
"""Recorded processor time of the tests of each stage that a mutant has to survive."""
_FILE_S = 40.0
"""Processor time after which a test is not recorded, nor any other of its file."""
_LEAST_S, _TIMES = 10.0, 20.0
"""Processor time that a test may take with a mutant, and how much more than without."""
_MOST_S, _MEMORY = 900, 12 * 2**30
"""Processor time and bytes of one process of tests; a mutant may fill more and more."""
_FIRST_SHARE = 0.8
"""Share of the time after which those follow that need another import; they are a tenth."""
_LAWS = "tests/test_values.py"
"""What holds for all defaults and start values, which execute no line of a function."""
_KERNELS = "_kernels.py"
_FATES = ("no test runs this line", "survived", "out of time", "killed")
_SAME = "no change"
_EMPTY: dict[str, Any] = {"tests": {}, "lines": {}}
_CRASH = {"fate": "killed", "by": "a crash"}

_Fate = dict[str, str]
_Place = tuple[str, str, int]
"""File, qualified name and first line of a function."""


@dataclass(frozen=True)
class Mutant:
    """One small change: which operator, at which of its places in a module."""

    module: str
    operator: str
    occurrence: int

    def lot(self, seed: int) -> bytes:
        """Whether it is drawn depends on itself alone, so that a sample outlives other changes."""
        return hashlib.sha256(f"{seed} {self}".encode()).digest()

    @property
    def path(self) -> Path:
        """Where its module is."""
        return SOURCE / self.module

    @cached_property
    def texts(self) -> tuple[str, str]:
        """The module before and after the change."""
        text = self.path.read_text("utf-8")
        changed = mutate_code(text, get_operator(self.operator)(), self.occurrence)
        assert changed is not None, self
        return text, changed

    def lines(self) -> range:
        """Lines of the statement that differs, or of the head of the compound statement."""
        lines = zip(*(text.splitlines() for text in self.texts), strict=False)
        line = next((k for k, (old, new) in enumerate(lines, start=1) if old != new), 1)
        found = range(line, line + 1)
        for node in ast.walk(ast.parse(self.texts[0])):
            if isinstance(node, ast.stmt):
                body = getattr(node, "body", None)
                end = body[0].lineno if body else (node.end_lineno or node.lineno) + 1
                if line in range(node.lineno, end):
                    found = range(node.lineno, end)
        return found

    def stages(self, far: bool) -> list[list[str]]:
        """The files of tests that may notice it, from the nearest."""
        own = Path("tests", *Path(self.module).parts[1:])
        own, folder = own.with_name(f"test_{own.name}"), own.parent
        while not any((ROOT / folder).glob("test_*.py")):
            folder = folder.parent
        found = [[ROOT / own, ROOT / _LAWS], (ROOT / folder).glob("test_*.py")]
        found += [(ROOT / "tests" / room).rglob("test_*.py") for room in ROOMS if far]
        files = [{p.relative_to(ROOT).as_posix() for p in paths if p.is_file()} for paths in found]
        return [sorted(some.difference(*files[:k])) for k, some in enumerate(files)]


def main() -> None:
    """Draw mutants, run their tests and print what survives."""
    parser = argparse.ArgumentParser(description="Run the tests against small faults.")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=300, help="number of mutants to draw")
    parser.add_argument("--minutes", type=float, default=30.0, help="no new one begins later")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "mutants.jsonl")
    parser.add_argument("--far", action="store_true", help="then also tests of other folders")
    chosen = parser.parse_args()
    every = [one for path in _modules() for one in _mutants(path)]
    drawn = heapq.nsmallest(chosen.count, every, key=lambda one: one.lot(chosen.seed))
    os.environ.setdefault("HYPERNAV_TEST_DATA", str(ROOT.parent / "shared" / "data"))
    chosen.out.parent.mkdir(parents=True, exist_ok=True)
    os.chdir(ROOT)

    start = time.monotonic()

    def run(attempt: Callable[[Mutant], _Fate | None], share: float) -> None:
        until, done = start + share * chosen.minutes * 60.0, _entries(chosen.out)
        for number, mutant in enumerate(drawn, start=1):
            began = time.monotonic()
            if mutant in done or began > until or (fate := attempt(mutant)) is None:
                continue
            entry = {
                "mutant": asdict(mutant),
                **fate,
                "seconds": round(time.monotonic() - began, 1),
                "diff": list(difflib.unified_diff(*map(str.splitlines, mutant.texts), n=2))[2:],
            }
            with chosen.out.open("a", encoding="utf-8") as file:
                print(json.dumps(entry), file=file)
            what = f"{mutant.module} {mutant.operator.partition('/')[2]}"
            print(f"{number}/{len(drawn)} {fate['fate']}: {what}", flush=True)

    def run_loaded(session: Session) -> None:
        tests = Tests(session)
        run(lambda mutant: tests.fate(mutant, chosen.far), _FIRST_SHARE)

    rooms = [_LAWS, *(f"tests/{room}" for room in ROOMS)]
    _in_fork(lambda: Session(run_loaded).start(rooms), quiet=False)
    run(lambda mutant: _imported_anew(mutant, chosen.far), 1.0)
    done = _entries(chosen.out)
    _report([done[one] for one in drawn if one in done], len(drawn), len(every))


def _modules() -> list[Path]:
    return sorted(p for room in ROOMS for p in (SOURCE / "hypernav" / room).rglob("*.py"))


def _mutants(path: Path) -> Iterator[Mutant]:
    nodes = list(ast_nodes(get_ast_from_path(path)))
    for name in OPERATORS:
        operator = get_operator(name)()
        places = sum(len(list(operator.mutation_positions(node))) for node in nodes)
        yield from (Mutant(path.relative_to(SOURCE).as_posix(), name, k) for k in range(places))


class Session:
    """One run of pytest that collects tests and then does with them what it is told; a plugin."""

    def __init__(self, work: Callable[["Session"], Any]) -> None:
        """Take what is to be done."""
        self.items: dict[str, pytest.Item] = {}
        self._work, self._answer = work, None
        self._cover: coverage.Coverage | None = None
        self._failed = False

    def start(self, paths: Sequence[str]) -> Any:
        """Collect the tests of these paths and do the work; None if they cannot be collected."""
        options = ["-q", "-s", "-p", "no:cacheprovider", "-m", "not slow and not freeze"]
        pytest.main([*options, *paths], plugins=[self])
        return self._answer

    def recorded(self, items: Sequence[pytest.Item]) -> dict[str, Any]:
        """How long each of these tests takes, if it passes, and the lines that it executes."""
        rooms = [f"{SOURCE}/hypernav/{room}/{part}" for room in ROOMS for part in ("*", "**/*")]
        self._cover = coverage.Coverage(data_file=None, config_file=False, include=rooms)
        self._cover.set_option("run:disable_warnings", ["no-data-collected"])
        self._cover.start()
        tests: dict[str, float] = {}
        spent, late = 0.0, list[str]()
        for item, following in pairwise([*items, None]):
            if spent >= _FILE_S:
                break
            began = time.process_time()
            passes = self._passes(item, following, _FILE_S, late)
            spent += (took := time.process_time() - began)
            if passes:
                tests[item.nodeid] = took
        self._cover.stop()
        data, lines = self._cover.get_data(), dict[str, dict[str, int]]()
        for path in data.measured_files():
            for line, contexts in data.contexts_by_lineno(path).items():
                for context in contexts:
                    of_file = lines.setdefault(Path(path).relative_to(SOURCE).as_posix(), {})
                    of_file[context] = of_file.get(context, 0) | 1 << line
        return {"tests": tests, "lines": lines}

    def fate(self, tests: Mapping[str, float]) -> _Fate:
        """Run tests until one fails."""
        late = list[str]()
        for item, following in pairwise([*(self.items[n] for n in tests if n in self.items), None]):
            passes = self._passes(item, following, _LEAST_S + _TIMES * tests[item.nodeid], late)
            if not passes and item.nodeid not in late:
                return {"fate": "killed", "by": item.nodeid}
            if len(late) == 2:
                break
        return {"fate": "out of time", "by": late[0]} if late else {"fate": "survived"}

    def _passes(
        self, item: pytest.Item, following: pytest.Item | None, within_s: float, late: list[str]
    ) -> bool:
        """Whether a test passes; it ends, and is noted as late, after this processor time."""

        def stop(*_: object) -> None:
            late.append(item.nodeid)
            raise _LateError

        self._failed = False
        signal.signal(signal.SIGPROF, stop)
        signal.setitimer(signal.ITIMER_PROF, within_s)
        item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        return not self._failed

    def pytest_sessionstart(self) -> None:
        """Draw the same examples each time; this comes after the profile of the tests."""
        from hypothesis import settings  # pytest rewrites its asserts before it is imported

        settings.register_profile("mutants", settings(), derandomize=True, database=None)
        settings.load_profile("mutants")

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Do the work instead of running all tests, if they could be collected."""
        if session.testsfailed:
            return True
        self.items = {item.nodeid: item for item in session.items}
        self._answer = self._work(self)
        return True

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """What fixtures execute belongs to all tests of the file."""
        if self._cover:
            self._cover.switch_context(item.location[0])

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_call(self, item: pytest.Item) -> None:
        """What the test itself executes is its own."""
        if self._cover:
            self._cover.switch_context(item.nodeid)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> pytest.TestReport:
        """Say whether it failed and nothing more: exchanged code has no lines to show."""
        outcome: Literal["passed", "failed", "skipped"] = "passed"
        if call.excinfo is not None:
            outcome = "skipped" if call.excinfo.errisinstance(pytest.skip.Exception) else "failed"
        return pytest.TestReport(item.nodeid, item.location, {}, outcome, None, call.when)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep whether anything failed."""
        self._failed |= report.failed


class _LateError(BaseException):
    """A test takes far longer than it does without the mutant."""


class Tests:
    """The tests of the imported package, of which any function can be exchanged in a fork."""

    def __init__(self, session: Session) -> None:
        """Import all modules and find their functions."""
        self._session, self._records = session, dict[str, Any]()
        package = _digest(sorted(SOURCE.rglob("*.py")))
        files = {one.location[0] for one in session.items.values()}
        self._states = {file: package + _digest([ROOT / file]) for file in files}
        for path in _modules():
            with suppress(ImportError):
                importlib.import_module(_name(path))
        gc.unfreeze()
        self._functions: dict[_Place, list[FunctionType]] = {}
        for one in gc.get_objects():
            if isinstance(one, FunctionType) and one.__code__.co_filename.startswith(str(SOURCE)):
                self._functions.setdefault(_place(one.__code__), []).append(one)

    def fate(self, mutant: Mutant, far: bool) -> _Fate | None:
        """Whether the tests that execute what differs notice it; None if no function does."""
        if len({ast.dump(ast.parse(text)) for text in mutant.texts}) == 1:
            return {"fate": _SAME}  # 1e+30 for 1e30
        if _name(mutant.path) not in sys.modules:
            return {"fate": _FATES[0]}  # it needs a package that is not installed
        loader: Any = sys.modules[_name(mutant.path)].__loader__
        old, new = (loader.source_to_code(text, str(mutant.path)) for text in mutant.texts)
        pairs = _exchanged(old, new)
        if not pairs or any(_place(code) not in self._functions for code, _ in pairs):
            for file in (file for files in mutant.stages(far) for file in files):
                self._recorded(file)
            return None
        exchanged = {one: code for was, code in pairs for one in self._functions[_place(was)]}
        is_kernel = mutant.module.endswith(_KERNELS)
        kernels, callers = self._calling(exchanged if is_kernel else ())
        places = [(Path(f.__code__.co_filename), _lines(f.__code__)) for f in callers]
        if not is_kernel:
            places = [(mutant.path, set(mutant.lines()))]
        fates: list[_Fate] = [{"fate": _FATES[0]}]
        for k, files in enumerate(mutant.stages(far)):
            tests = dict[str, float]()
            for file in files:
                record = self._recorded(file)
                # Lines of kernels are nowhere recorded.
                tests |= (
                    record["tests"] if is_kernel and k == 0 else _executing(record, file, places)
                )
            if tests:
                call = partial(self._after_exchange, exchanged, kernels, _cheapest(tests))
                fates.append(_in_fork(call) or _CRASH)
            if fates[-1]["fate"] == "killed":
                break
        return max(fates, key=lambda one: _FATES.index(one["fate"]))

    def _recorded(self, file: str) -> dict[str, Any]:
        """What is known of a file of tests; they run now if that is outdated."""
        if file not in self._records:
            kept = _kept(file)
            record = json.loads(kept.read_text("utf-8")) if kept.is_file() else {}
            if record.get("state") != self._states.get(file, ""):
                began = time.monotonic()
                items = [one for one in self._session.items.values() if one.location[0] == file]
                record = _in_fork(lambda: self._session.recorded(items)) or dict(_EMPTY)
                record["state"] = self._states.get(file, "")
                kept.parent.mkdir(parents=True, exist_ok=True)
                kept.write_text(json.dumps(record), "utf-8")
                what = f"{len(record['tests'])} of {len(items)} tests of {file}"
                print(f"recorded {what} in {time.monotonic() - began:.0f} s", flush=True)
            self._records[file] = record
        return self._records[file]

    def _calling(
        self, changed: Iterable[FunctionType]
    ) -> tuple[set[FunctionType], set[FunctionType]]:
        """These functions with all kernels that call them, and what else calls one of those."""
        kernels, callers, size = set(changed), set[FunctionType](), -1
        while size != len(kernels):
            size = len(kernels)
            for one in [one for functions in self._functions.values() for one in functions]:
                called = (one.__globals__.get(name) for name in _names(one.__code__))
                # Numba gives an object for a compiled function, which keeps the function itself.
                if not kernels.isdisjoint(
                    it
                    for it in (getattr(it, "py_func", it) for it in called)
                    if isinstance(it, FunctionType)
                ):
                    (kernels if one.__code__.co_filename.endswith(_KERNELS) else callers).add(one)
        return kernels, callers

    def _after_exchange(
        self,
        exchanged: Mapping[FunctionType, CodeType],
        kernels: set[FunctionType],
        tests: Mapping[str, float],
    ) -> _Fate:
        for one, code in exchanged.items():
            one.__code__ = code
        for module in list(sys.modules.values()):
            for key, value in list(vars(module).items()):
                if isinstance(value, Dispatcher) and value.py_func in kernels:
                    setattr(module, key, value.py_func)
        return self._session.fate(tests)


def _imported_anew(mutant: Mutant, far: bool) -> _Fate:
    """Whether a default, a constant or the like is noticed by an import of the package."""
    get_code = SourceFileLoader.get_code

    def mutated(self: SourceFileLoader, name: str) -> CodeType | None:
        is_it = self.path == str(mutant.path)
        return self.source_to_code(mutant.texts[1], self.path) if is_it else get_code(self, name)

    def within(tests: Mapping[str, float]) -> _Fate:
        SourceFileLoader.get_code = mutated
        numba.config.DISABLE_JIT = mutant.module.endswith(_KERNELS)
        files = {name.partition("::")[0]: None for name in tests}
        fate = Session(lambda session: session.fate(tests)).start([*files])
        return fate or {"fate": "killed", "by": "the import"}

    fates: list[_Fate] = [{"fate": _FATES[0]}]
    everywhere = [(mutant.path, range(1, len(mutant.texts[0].splitlines()) + 1))]
    for k, files in enumerate(mutant.stages(far)):
        tests = dict[str, float]()
        for file in files:
            kept = _kept(file)
            record = json.loads(kept.read_text("utf-8")) if kept.is_file() else _EMPTY
            tests |= record["tests"] if k < 2 else _executing(record, file, everywhere)
        if tests and fates[-1]["fate"] != "killed":
            fates.append(_in_fork(partial(within, _cheapest(tests))) or _CRASH)
    return max(fates, key=lambda one: _FATES.index(one["fate"]))


def _executing(
    record: Mapping[str, Any], file: str, places: Iterable[tuple[Path, Iterable[int]]]
) -> dict[str, float]:
    """The tests of a file that execute one of these lines."""
    tests, found = record["tests"], dict[str, float]()
    for path, lines in places:
        wanted = sum(1 << line for line in set(lines))
        contexts = record["lines"].get(path.relative_to(SOURCE).as_posix(), {})
        for context in (one for one, executed in contexts.items() if executed & wanted):
            names = tests if context == file else [context]
            found |= {name: tests[name] for name in names if name in tests}
    return found


def _cheapest(tests: Mapping[str, float]) -> dict[str, float]:
    """The tests from the cheapest on, until enough are found."""
    order = sorted(tests, key=lambda name: tests[name])
    before = accumulate((tests[name] for name in order), initial=0.0)
    pairs = zip(order, before, strict=False)  # the last sum is of all
    return {name: tests[name] for name, spent in pairs if spent < _TESTS_S}


def _in_fork(work: Callable[[], Any], *, quiet: bool = True) -> Any:
    """What some work in a process of its own returns; nothing if that crashes."""
    with tempfile.TemporaryFile("w+", encoding="utf-8") as answer:
        child = os.fork()
        if not child:
            os.setsid()
            code = 1
            if quiet:
                nowhere = os.open(os.devnull, os.O_RDWR)
                os.dup2(nowhere, 1)
                os.dup2(nowhere, 2)
                resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
                resource.setrlimit(resource.RLIMIT_CPU, (_MOST_S, _MOST_S))
            try:
                json.dump(work(), answer)
                code = 0
            except BaseException:
                answer.write(traceback.format_exc())
            finally:
                answer.flush()
                os._exit(code)
        _, status = os.waitpid(child, 0)
        with suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)  # what its tests have left
        answer.seek(0)
        if os.WIFEXITED(status) and os.WEXITSTATUS(status):
            raise RuntimeError(answer.read())
        return json.load(answer) if os.WIFEXITED(status) else None


def _kept(file: str) -> Path:
    """Where the record of a file of tests is kept."""
    return ROOT / "build" / "mutants" / f"{file}.json"


def _digest(paths: Iterable[Path]) -> str:
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()


def _name(path: Path) -> str:
    return ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__")


def _place(code: CodeType) -> _Place:
    return code.co_filename, code.co_qualname, code.co_firstlineno


def _lines(code: CodeType) -> set[int]:
    return {line for *_, line in code.co_lines() if line}


def _names(code: CodeType) -> set[str]:
    """All names that a function uses, inside of its comprehensions, too."""
    inner = (one for one in code.co_consts if isinstance(one, CodeType))
    return set(code.co_names).union(*map(_names, inner))


def _exchanged(old: CodeType, new: CodeType) -> list[tuple[CodeType, CodeType]]:
    """Each function that differs, before and after; none if something outside differs."""
    if old.co_flags & CO_OPTIMIZED:
        return [(old, new)] if old != new else []
    inner, outer = [], []
    for code in (old, new):
        inner.append([one for one in code.co_consts if isinstance(one, CodeType)])
        rest = [one for one in code.co_consts if not isinstance(one, CodeType)]
        outer.append((code.co_code, code.co_names, repr(rest)))
    if outer[0] != outer[1]:
        return []
    return [pair for both in zip(*inner, strict=True) for pair in _exchanged(*both)]


def _entries(path: Path) -> dict[Mutant, dict[str, Any]]:
    lines = path.read_text("utf-8").splitlines() if path.is_file() else []
    return {Mutant(**entry["mutant"]): entry for entry in map(json.loads, lines)}


def _report(entries: Sequence[dict[str, Any]], drawn: int, every: int) -> None:
    entries = [entry for entry in entries if entry["fate"] != _SAME]
    for entry in entries:
        if entry["fate"] != "killed":
            print(f"\n{entry['fate']}: {entry['mutant']}", *entry["diff"], sep="\n")
    for room in ("", *ROOMS):
        of_room = [one for one in entries if one["mutant"]["module"].startswith(f"hypernav/{room}")]
        fates = Counter(one["fate"] for one in of_room)
        share = f"{fates['killed'] / len(of_room):.1%}" if of_room else "none"
        print(f"{room or 'all'}: {share} of {len(of_room)} killed; {dict(fates)}")
    print(f"{drawn} drawn of {every}, {drawn - len(entries)} not run")


if __name__ == "__main__":
    main()
