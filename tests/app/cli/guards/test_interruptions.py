import os
import pty
import signal
import subprocess
import sys
import time
import weakref
from contextlib import contextmanager, nullcontext

import pytest

from hypernav.app.cli.guards.crashes import ExitStatus, crash_report
from hypernav.app.cli.guards.interruptions import (
    Terminated,
    UninterruptedEnd,
    interruptions_put_off,
    sigterm_as_interruption,
)


@pytest.fixture(autouse=True)
def sigint_as_in_a_terminal():
    """A background job of a shell starts with SIGINT ignored, and Python leaves it so."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(autouse=True)
def sighup_as_in_a_terminal():
    """Programs of the background may start with SIGHUP ignored, too."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_one_that_comes_where_nothing_can_be_raised_ends_the_block_all_the_same(number, capsys):
    """Python reports what a callback of a weak reference raises, and goes on."""

    class Lock:
        pass

    before = sys.unraisablehook
    locks = [Lock()]
    _reference = weakref.ref(locks[0], lambda _: signal.raise_signal(number))

    def lose_the_lock():
        locks.clear()
        time.sleep(10.0)

    with pytest.raises(KeyboardInterrupt), sigterm_as_interruption():
        lose_the_lock()
    assert sys.unraisablehook is before
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_sigterm_and_sighup_end_a_block_as_ctrl_c_does(number):
    before = signal.getsignal(number)
    with pytest.raises(KeyboardInterrupt), sigterm_as_interruption():
        signal.raise_signal(number)
    assert signal.getsignal(number) == before


def test_what_nohup_started_minds_no_lost_terminal():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with sigterm_as_interruption(), interruptions_put_off():
        signal.raise_signal(signal.SIGHUP)
    assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN


@pytest.mark.parametrize(
    ("number", "error"),
    [
        (signal.SIGINT, KeyboardInterrupt),
        (signal.SIGTERM, Terminated),
        (signal.SIGHUP, Terminated),
    ],
)
def test_a_block_that_puts_it_off_comes_to_its_end(number, error):
    done = []

    def block():
        with sigterm_as_interruption(), interruptions_put_off():
            signal.raise_signal(number)
            signal.raise_signal(number)
            done.append("all")

    with pytest.raises(error):
        block()
    assert done == ["all"]


@pytest.mark.parametrize("error", [None, KeyboardInterrupt, ValueError])
def test_a_context_comes_to_its_end_however_often_one_interrupts(error):
    said = []

    @contextmanager
    def robot():
        try:
            yield "robot"
        finally:
            said.append("stand")
            signal.raise_signal(signal.SIGINT)
            said.append("stands")

    def search():
        with UninterruptedEnd(robot()) as entered:
            said.append(entered)
            if error is not None:
                raise error

    with pytest.raises(KeyboardInterrupt):
        search()
    assert said == ["robot", "stand", "stands"]


def test_one_who_interrupts_while_it_must_wait_is_told_what_for(capfd):
    def search():
        with UninterruptedEnd(nullcontext(), "waiting until the robot stands"):
            pass

    search()
    assert capfd.readouterr().err == ""

    @contextmanager
    def interrupted():
        yield
        signal.raise_signal(signal.SIGINT)

    with (
        pytest.raises(KeyboardInterrupt),
        UninterruptedEnd(interrupted(), "waiting until the robot stands"),
    ):
        pass
    assert capfd.readouterr().err == "\nhypernav: waiting until the robot stands\n"


def test_a_terminal_that_goes_cuts_no_end_short(tmp_path):
    said = tmp_path / "said"
    program = (
        "import os, time\n"
        "from contextlib import contextmanager\n"
        "from hypernav.app.cli import main\n"
        "from hypernav.app.cli.guards.interruptions import UninterruptedEnd\n"
        "from hypernav.app.cli.screen.terminal import Terminal\n"
        "import hypernav.app.cli.command_line as line\n"
        "os.open(os.ttyname(0), os.O_RDWR)  # becomes the terminal of the session\n"
        "console = Terminal()\n"
        "@contextmanager\n"
        "def robot():\n"
        "    try:\n"
        "        yield\n"
        "    finally:\n"
        "        console.print('the robot is told to stand')\n"
        f"        open({str(said)!r}, 'w').write('stands')\n"
        "def run(_):\n"
        "    with UninterruptedEnd(robot(), 'waiting'), console.status('searching'):\n"
        "        console.print('ready')\n"
        "        for _ in range(1000):\n"  # right before a long one a signal would wait
        "            time.sleep(0.1)\n"
        "line.run_command = run\n"
        "main.main([])\n"
    )
    terminal, slave = pty.openpty()
    command = [sys.executable, "-c", program]
    with subprocess.Popen(
        command, stdin=slave, stdout=slave, stderr=slave, start_new_session=True
    ) as process:
        os.close(slave)
        heard = b""
        while b"ready" not in heard:
            heard += os.read(terminal, 1000)
        os.close(terminal)
        assert process.wait() == ExitStatus.TERMINATED
    assert said.read_text() == "stands"


def test_without_an_interruption_nothing_is_raised():
    with sigterm_as_interruption(), interruptions_put_off():
        pass


def test_an_interruption_in_a_compiled_function_is_no_crash(tmp_path):
    with pytest.raises(Terminated), crash_report(tmp_path):
        raise SystemError("returned a result with an exception set") from Terminated()
    assert not list(tmp_path.iterdir())


INSISTS = """
import signal, time
from hypernav.app.cli.guards.interruptions import interruptions_put_off, sigterm_as_interruption
with sigterm_as_interruption():
    for _ in range({times}):
        try:
            signal.raise_signal(signal.{number})
        except BaseException:  # as a component may do
            pass
        {between}
        time.sleep({pause_s})
"""


@pytest.mark.parametrize(("number", "status"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_who_interrupts_twice_ends_what_swallows_it(number, status):
    def ended(times, between="pass", pause_s=0.4):
        program = INSISTS.format(number=number, times=times, between=between, pause_s=pause_s)
        return subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=False
        )

    assert ended(1).returncode == 0
    twice = ended(2)
    assert twice.returncode == status
    assert "hypernav: interrupted twice" in twice.stderr
    assert ended(2, "with interruptions_put_off(): pass").returncode == 0
    assert ended(2, pause_s=0.0).returncode == 0  # `timeout` sends the same signal twice


def test_a_background_job_minds_no_ctrl_c():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with sigterm_as_interruption():
        signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
