"""Interruptions that compiled code turned into a `SystemError`."""

import itertools

import pytest

from hypernav.core.interruptions import interruptions_of_kernels


def fail(*chain):
    """Raise the first of some errors, of which each one has the next for its cause."""
    for error, cause in itertools.pairwise(chain):
        error.__cause__ = cause
    raise chain[0]


@pytest.mark.parametrize("kind", [KeyboardInterrupt, SystemExit])
@pytest.mark.parametrize("depth", [1, 2])
def test_an_interruption_is_raised_as_what_it_is(kind, depth):
    interruption = kind()
    faults = [SystemError("returned a result with an exception set") for _ in range(depth)]
    with pytest.raises(kind) as raised, interruptions_of_kernels():
        fail(*faults, interruption)
    assert raised.value is interruption


@pytest.mark.parametrize("cause", [None, ValueError("no interruption")])
def test_another_fault_of_python_stays_one(cause):
    with pytest.raises(SystemError, match="bad call"), interruptions_of_kernels():
        fail(SystemError("bad call"), cause)
