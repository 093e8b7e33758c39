import io
import time

from hypernav.app.cli.screen.counter import Counter
from hypernav.app.cli.screen.terminal import Terminal


def test_into_a_pipe_go_lines_also_while_nothing_is_done(monkeypatch):
    written = io.StringIO()
    monkeypatch.setattr("sys.stderr", written)
    with Counter(Terminal(), "making [the] first", line_every_s=0.01) as counter:
        wait_for(lambda: written.getvalue().count("making [the] first (") >= 2)
        counter.update("1 of 2 questions")
        wait_for(lambda: "1 of 2 questions (" in written.getvalue())
    lines = written.getvalue().splitlines()
    times = [line.partition("(")[2] for line in lines]
    assert len(set(times)) > 1  # the clock goes on
    before = len(lines)
    time.sleep(0.05)
    assert len(written.getvalue().splitlines()) == before  # and ends with the block


def test_quiet_says_nothing(monkeypatch):
    written = io.StringIO()
    monkeypatch.setattr("sys.stderr", written)
    with Counter(Terminal(quiet=True), "a", line_every_s=0.001):
        time.sleep(0.02)
    assert written.getvalue() == ""


def wait_for(condition):
    until = time.monotonic() + 10.0
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.005)
