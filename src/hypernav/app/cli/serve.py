"""The command `hypernav serve`: receive the observations of robots, and say where to go."""

import dataclasses
import logging
import sys
from pathlib import Path

from rich.markup import escape

from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.outputs import check_folder
from hypernav.app.cli.options.agent import check_memory_options
from hypernav.app.cli.options.commands import ServeOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.app.warmup.background import warm_up_in_background
from hypernav.core.components.registry import require
from hypernav.core.config import check_option

_MODULES = ("fastapi", "uvicorn", "websockets")
_PATIENCE_S = 2.0
"""Longest wait for a last search or server that still saves to the memory, seconds."""


def run(options: ServeOptions) -> int:
    """Run the command until it is interrupted.

    Raises:
        MemoryFolderError: The memory is broken, can't be read now, or is that of a simulated
            building; or the folder holds something else.
        ConfigError: An option, the address or the token cannot be used.
        MissingExtraError: The packages of a server, or of a component, are not installed.
        ModelError: A model's file cannot be used.
        OutputError: The folder of the searches, or that of the memory, cannot be written.
        RunFolderError: Another server uses it, or another program the memory.
    """
    for module in _MODULES:
        require(module, extra="robot")
    from hypernav.app.build.presets import HyPerNavConfig
    from hypernav.robot.server.guard import Access
    from hypernav.robot.server.limits import ServerLimits
    from hypernav.robot.server.searches.agents import AgentPlan
    from hypernav.robot.server.serving import check_access, read_token, serve
    from hypernav.robot.wire.requests import OpenSearch

    check_option("--port", options.port, (0, 65_535), "ports are whole numbers")
    check_option("--max-searches", options.max_searches, (1, 1000), "each takes a thread")
    check_option("--idle-minutes", options.idle_minutes, (0.0, 1e6), "minutes, at most two years")
    check_memory_options(options)
    token = None if options.token_file is None else read_token(options.token_file)
    access = Access(options.host, token)
    check_access(access)
    check_folder(options.state)
    memory = None if options.memory is None else options.memory.absolute()
    damaged = () if memory is None else _check_memory(memory)

    def plan(request: OpenSearch) -> AgentPlan:
        who = dataclasses.replace(
            options.who,
            preset=request.preset or options.who.preset,
            agent=request.agent or options.who.agent,
        )
        config = who.resolve(request.robot)
        # The robot's own description replaces that of the configuration.
        values = config.model_dump() | {"embodiment": request.robot.model_dump()}
        config = HyPerNavConfig.model_validate(values).for_steps(request.max_steps)
        return AgentPlan(
            config, who.specs, memory, options.memory_mb, relocalize=options.relocalize
        )

    own = options.who.resolve()
    detector = AgentPlan(own, options.who.specs, memory, options.memory_mb).check()
    console = Terminal(quiet=False)
    logging.basicConfig(
        stream=sys.stderr, level=logging.WARNING, format="%(levelname)s %(message)s"
    )

    for line in damaged:
        console.print(f"[yellow]{escape(f'{memory}: {line}')}[/]", soft_wrap=True)

    def say(url: str) -> None:
        console.print(
            f"serving at {escape(url)}, detector {escape(detector)}, searches in "
            f"{escape(str(options.state))}; Ctrl-C ends it; the next start continues the searches",
            soft_wrap=True,
        )

    limits = ServerLimits(searches=options.max_searches, idle_s=60.0 * options.idle_minutes)
    with warm_up_in_background(console.print):
        serve(access, options.port, options.state, plan, limits, memory=memory, on_start=say)
    return ExitStatus.SUCCESS


def _check_memory(folder: Path) -> tuple[str, ...]:
    """Refuse a memory that no search could begin with, or be saved to, before a robot comes.

    Returns:
        One line about each part that is damaged.

    Raises:
        MemoryFolderError: As `run`.
        OutputError: The folder cannot be written.
        RunFolderError: Another program uses it, and may be saving to it.
    """
    from hypernav.io.folder_lock import folder_lock
    from hypernav.search.memory.store.memory_folder import check_is_of_robot
    from hypernav.search.memory.store.memory_reader import (
        check_not_inside_another,
        read_index,
        read_memory,
    )

    check_folder(folder)
    check_not_inside_another(folder)
    read_index(folder)  # refuses other files before the lock adds its own
    if not folder.exists():  # it begins with the first search
        return ()
    with folder_lock(folder, option="--memory", patience_s=_PATIENCE_S) as home:
        index = read_index(folder)
        if index is None:
            return ()
        check_is_of_robot(folder, index.place)
        contents = read_memory(home, index.mapping, index.robot)
    return () if contents is None else contents.left_out
