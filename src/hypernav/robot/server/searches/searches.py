"""All searches of a server, in memory and on disk."""

import logging
import secrets
import shutil
import threading
import time
from contextlib import ExitStack, closing
from importlib.metadata import version
from pathlib import Path

from hypernav.core.errors import HyPerNavError, RequestRefusedError, RunFolderError
from hypernav.core.goal import Goal
from hypernav.io.folder_lock import folder_lock
from hypernav.robot.server.limits import Pace, ServerLimits
from hypernav.robot.server.searches.agents import AgentPlan, PlanAgent, check_labels
from hypernav.robot.server.searches.decisions import Decisions
from hypernav.robot.server.searches.journal import Journal, SearchRecord
from hypernav.robot.server.searches.search import Search
from hypernav.robot.wire.replies import SearchEnding
from hypernav.robot.wire.requests import OpenSearch, ThingName
from hypernav.robot.wire.values import SEARCHES
from hypernav.search.memory.memory import Memory

_LOG = logging.getLogger(__name__)
_PATIENCE_S = 2.0
"""Longest wait for pending decisions when the server ends."""
_MEMORY_CHANGED = (
    "the server was started again, and the memory {} is no longer the one that the search began "
    "with, so what it decided can't be repeated; open a new search"
)


class Searches:
    """The searches in a state folder, which one server at a time may use.

    Searches that were under way when the last server ended are taken up again.
    """

    def __init__(self, state: Path, plan: PlanAgent, limits: ServerLimits) -> None:
        """Create it; the ``with`` block opens the folder.

        Args:
            state: Folder of all searches.
            plan: Chooses the agent for a request.
            limits: Limits of the server.
        """
        self._folder = state / "searches"
        self._open = ExitStack()
        self._folder_lock = folder_lock(state, option="--state")
        self._plan = plan
        self._limits = limits
        self._lock = threading.Lock()
        self._searches: dict[str, Search] = {}
        self._keys: dict[str, str] = {}
        self._stops = 0
        self._pace = Pace()

    def __enter__(self) -> "Searches":
        """Lock the folder, and take up unfinished searches.

        Raises:
            RunFolderError: Another server uses it, or it cannot be written.
        """
        self._open.enter_context(self._folder_lock)
        try:
            self._folder.mkdir(exist_ok=True)
        except OSError as error:
            raise RunFolderError(f"cannot create {self._folder}: {error.strerror}") from error
        for folder in sorted(self._folder.iterdir()):
            self._load(folder)
        return self

    def __exit__(self, *error: object) -> None:
        """Release all searches; those that are not over can be taken up again."""
        workers = [search.halt() for search in self.all()]
        end = time.monotonic() + _PATIENCE_S
        for worker in workers:
            if worker is not None:
                worker.join(max(end - time.monotonic(), 0.0))
        self._open.close()

    def open(self, request: OpenSearch) -> Search:
        """Begin a search, or return that of the same key.

        Raises:
            RequestRefusedError: Images are too large, there are too many searches, the key is that
                of a search for another goal or by another robot, or the memory is in use or does
                not have the thing.
            HyPerNavError: No such agent can be built, or the goal can never be found.
        """
        stops = self._stops
        with self._lock:
            if request.key is not None and request.key in self._keys:
                return _same(self._searches[self._keys[request.key]], request)
            self._check_room(request)
            name = secrets.token_hex(16)
            folder = self._folder / name
            try:
                search = self._begun(name, folder, request)
            except HyPerNavError:
                shutil.rmtree(folder, ignore_errors=True)
                raise
            self._add(search)
        if self._stops > stops:
            search.stop("stopped while it was opened")
            search.write_end()
        return search

    def end_silent(self) -> None:
        """End every search whose robot has sent nothing for too long."""
        idle_s = self._limits.idle_s
        for search in self.all():
            if not search.is_over and search.silent_s > idle_s:
                words = f"its robot was silent for {_minutes(idle_s)}"
                search.stop(words, SearchEnding.ROBOT_FAILED)
                try:
                    search.write_end()
                except RunFolderError as error:
                    _LOG.error("search %s: %s", search.record.id, error)

    def stop_all(self, reason: str) -> list[Search]:
        """Stop every robot at once; `Search.write_end` writes it to disk.

        Args:
            reason: Who stops them, or why.

        Returns:
            The searches that were under way, and those whose end is not written yet. A search that
            is just being opened is stopped, too.
        """
        self._stops += 1
        stopped = [search for search in self.all() if not search.is_end_kept]
        for search in stopped:
            search.stop(reason)
        return stopped

    def find(self, name: str) -> Search:
        """A search by its name.

        Raises:
            RequestRefusedError: There is none of this name.
        """
        search = self._searches.get(name)
        if search is None:
            raise RequestRefusedError(f"there is no search {name}", error="unknown", status=404)
        return search

    def all(self) -> list[Search]:
        """All searches, the latest first."""
        found = list(self._searches.values())
        return sorted(found, key=lambda search: search.record.opened_s, reverse=True)

    def _begun(self, name: str, folder: Path, request: OpenSearch) -> Search:
        plan, goal = self._plan(request), Goal(request.goal)
        self._check_memory_is_free(plan)
        if request.thing is not None:
            check_remembers_things(plan.memory)
        built = plan.build(goal, folder)
        with ExitStack() as failed:
            failed.callback(built.close)
            check_labels(built, request)
            memory = plan.open_memory()
            if memory is not None:
                failed.callback(memory.leave)
                if request.thing is not None:
                    _check_knows(memory.memory, request.thing)
            record = SearchRecord(
                id=name,
                opened_s=time.time(),
                version=version("hypernav"),
                words=f"detector {built.detector_words}, reasoner {built.reasoner_words}",
                request=request,
                specs=plan.specs,
                config=plan.config,
                memory=plan.memory,
                memory_mb=plan.memory_mb,
                relocalize=plan.relocalize and memory is not None and memory.index is not None,
                memory_save=None if memory is None else memory.save_name,
                earlier_searches=None if memory is None else memory.memory.searches,
            )
            search = Search(Journal.create(folder, record), self._pace)
            failed.pop_all()
        search.go_on(Decisions(record, built, memory))
        return search

    def _check_memory_is_free(self, plan: AgentPlan) -> None:
        """Refuse a second search with one memory: what is known has one robot at a time.

        Raises:
            RequestRefusedError: A search with the memory is under way.
        """
        for search in self.all():
            if plan.memory is not None and search.has_memory:
                raise RequestRefusedError(
                    f"the search {search.record.id} for {search.record.request.goal!r} is under "
                    f"way and uses the server's memory; close it by POST {SEARCHES}/ID/close, or "
                    "start another server without --memory",
                    error="memory",
                    status=409,
                )

    def _load(self, folder: Path) -> None:
        """Take up a search of an earlier server; a damaged one is skipped."""
        try:
            with ExitStack() as opened:
                journal = opened.enter_context(closing(Journal(folder)))
                search = Search(journal, self._pace)
                if not search.is_over:
                    # With the options that it was opened with, not the server's present ones.
                    record = journal.record
                    plan = AgentPlan(record.config, record.specs, record.memory, record.memory_mb)
                    memory = plan.open_memory() if search.has_memory else None
                    if memory is not None:
                        opened.callback(memory.leave)
                    if memory is not None and record.memory_save not in (None, memory.save_name):
                        search.stop(_MEMORY_CHANGED.format(record.memory), SearchEnding.FAILED)
                        search.write_end()
                    else:
                        built = plan.build(Goal(record.request.goal), folder)
                        opened.callback(built.close)
                        search.go_on(Decisions(record, built, memory, search.status().start))
                        opened.pop_all()
        except HyPerNavError as error:
            _LOG.error("the search in %s cannot be taken up: %s", folder.name, error)
            return
        self._add(search)

    def _add(self, search: Search) -> None:
        self._searches[search.record.id] = search
        if search.record.request.key is not None:
            self._keys[search.record.request.key] = search.record.id

    def _check_room(self, request: OpenSearch) -> None:
        limits, camera = self._limits, request.embodiment.camera
        pixels = camera.width * camera.height
        if pixels > limits.pixels:
            raise RequestRefusedError(
                f"images of {camera.width} × {camera.height} pixels are {pixels:,} pixels, at most "
                f"{limits.pixels:,} are taken; send smaller ones",
                error="too-large",
                status=422,
            )
        if len(self._searches) >= limits.kept:
            raise _busy(
                f"the server keeps {limits.kept:,} searches, as many as it may; its operator can "
                "move old folders out of --state"
            )
        self.end_silent()
        under_way = [search for search in self._searches.values() if not search.is_over]
        if len(under_way) >= limits.searches:
            quietest = max(under_way, key=lambda search: search.silent_s)
            left_s = max(limits.idle_s - quietest.silent_s, 0.0)
            raise _busy(
                f"{len(under_way)} searches are under way, as many as there may be; close one by "
                f"POST {SEARCHES}/ID/close. The one that has been silent longest, "
                f"{quietest.record.id}, ends after another {_minutes(left_s)} of silence"
            )
        median_s = self._pace.median_s()
        if under_way and median_s is not None and median_s > limits.answer_s:
            raise _busy(
                f"this server is busy: the robots of its {len(under_way)} searches wait "
                f"{1e3 * median_s:.0f} ms for an answer (median of the last seconds, without the "
                f"time of chat models), and {1e3 * limits.answer_s:.0f} are the limit; try again "
                "when a search has ended, or use another server"
            )


def _same(search: Search, request: OpenSearch) -> Search:
    """The search of a key, if it is the one that the robot means."""
    goal = search.record.request.goal
    if goal != request.goal:
        message = f"this key is that of a search for {goal!r}; make up another one"
        raise RequestRefusedError(message, error="key", status=409)
    if search.record.request.robot != request.robot:
        message = (
            "this key is that of a search by a robot with another body, camera or step; make up "
            "another one"
        )
        raise RequestRefusedError(message, error="key", status=409)
    return search


def check_remembers_things(memory: Path | None) -> None:
    """Refuse to be sent to a remembered thing by a server that remembers none.

    Raises:
        RequestRefusedError: It has no memory.
    """
    if memory is None:
        raise RequestRefusedError(
            "this server has no memory, so there is no remembered thing to go to; leave out the "
            "thing, or start it with --memory",
            error="memory",
            status=409,
        )


def no_such_thing(thing: ThingName) -> RequestRefusedError:
    """Refusal of a thing that the memory does not have, or knows to be gone."""
    return RequestRefusedError(
        f"the memory has no thing {thing.number} on floor {thing.floor}, or it is gone",
        error="memory",
        status=409,
    )


def _check_knows(memory: Memory, thing: ThingName) -> None:
    floors = memory.floors[thing.floor - 1 : thing.floor]
    known = floors[0].things.find(thing.number) if floors else None
    if known is None or known.is_gone:
        raise no_such_thing(thing)


def _busy(message: str) -> RequestRefusedError:
    return RequestRefusedError(message, error="busy", status=429)


def _minutes(seconds: float) -> str:
    return f"{seconds / 60.0:.0f} min" if seconds >= 60.0 else f"{seconds:.0f} s"
