import signal
from contextlib import contextmanager

import pytest

from hypernav.cli.guards.crashes import crash_report
from hypernav.cli.guards.interruptions import (
    EndedInPeace,
    Terminated,
    interruptions_put_off,
    sigterm_as_interruption,
)


@pytest.fixture(autouse=True)
def sigint_as_in_a_terminal():
    """A background job of a shell starts with SIGINT ignored, and Python leaves it so."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_sigterm_ends_a_block_as_ctrl_c_does():
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(KeyboardInterrupt), sigterm_as_interruption():
        signal.raise_signal(signal.SIGTERM)
    assert signal.getsignal(signal.SIGTERM) == before


@pytest.mark.parametrize(
    ("number", "error"), [(signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, Terminated)]
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
        with EndedInPeace(robot()) as entered:
            said.append(entered)
            if error is not None:
                raise error

    with pytest.raises(KeyboardInterrupt):
        search()
    assert said == ["robot", "stand", "stands"]


def test_without_an_interruption_nothing_is_raised():
    with sigterm_as_interruption(), interruptions_put_off():
        pass


def test_an_interruption_in_a_compiled_function_is_no_crash(tmp_path):
    with pytest.raises(Terminated), crash_report(tmp_path):
        raise SystemError("returned a result with an exception set") from Terminated()
    assert not list(tmp_path.iterdir())
