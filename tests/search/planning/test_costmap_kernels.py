"""The heap of the nodes that a plan of actions has still to look at."""

import heapq

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from hypernav.search.planning.costmap_kernels import drop_first, push


@given(st.lists(st.one_of(st.none(), st.integers(0, 20)), max_size=40))
@example([1, 3, 2, 7, 4, 6, 5, None, 0, None, None, None, None, None, None])
@example([5, 1, 4, 2, 3, None, None, None, None, None])
def test_the_first_of_a_heap_always_has_the_smallest_key(operations):
    """A number is put in, None takes the first one out."""
    keys, nodes, reference = np.zeros(41), np.zeros(41, np.int64), []
    for node, key in enumerate(operations):
        if key is not None:
            push(keys, nodes, len(reference), float(key), node)
            heapq.heappush(reference, key)
        elif reference:
            drop_first(keys, nodes, len(reference))
            heapq.heappop(reference)
        size = len(reference)
        assert sorted(keys[:size]) == sorted(reference)
        assert [operations[one] for one in nodes[:size]] == keys[:size].tolist()
        if size:
            assert keys[0] == reference[0]
            assert all(keys[i] >= keys[(i - 1) // 2] for i in range(1, size))
