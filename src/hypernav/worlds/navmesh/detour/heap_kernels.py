"""The heap of Detour's searches, ``dtNodeQueue`` (numba kernels).

Its order decides between two paths of equal cost, so it is the same as Detour's.
"""

from numba import njit


@njit(cache=True)
def push(heap, size, node, total):
    """Add a node to a heap; returns its new size."""
    _rise(heap, size, node, total)
    return size + 1


@njit(cache=True)
def pop(heap, size, total):
    """Take the node with the least total from a heap; returns it and the new size."""
    least, last = heap[0], heap[size - 1]
    size -= 1
    i, child = 0, 1
    while child < size:
        if child + 1 < size and total[heap[child]] > total[heap[child + 1]]:
            child += 1
        heap[i] = heap[child]
        i, child = child, 2 * child + 1
    _rise(heap, i, last, total)
    return least, size


@njit(cache=True)
def lower(heap, size, node, total):
    """Move a node of a heap up after its total was lowered."""
    for i in range(size):
        if heap[i] == node:
            _rise(heap, i, node, total)
            return


@njit(cache=True)
def _rise(heap, i, node, total):
    parent = (i - 1) // 2
    while i > 0 and total[heap[parent]] > total[node]:
        heap[i] = heap[parent]
        i, parent = parent, (parent - 1) // 2
    heap[i] = node
