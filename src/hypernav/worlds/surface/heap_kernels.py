"""A binary heap of growing arrays: the vertex with the smallest distance first (numba kernels)."""

import numpy as np
from numba.extending import register_jitable


@register_jitable(no_cfunc_wrapper=True)
def _doubled(array):
    longer = np.empty(array.size * 2, dtype=array.dtype)
    for k in range(array.size):
        longer[k] = array[k]
    return longer


@register_jitable(no_cfunc_wrapper=True)
def push(keys, items, size, key, item):
    """Add to a binary heap; returns its arrays, which may be new ones."""
    if size == keys.size:
        keys, items = _doubled(keys), _doubled(items)
    k = size
    while k > 0:
        parent = (k - 1) >> 1
        if keys[parent] <= key:
            break
        keys[k], items[k] = keys[parent], items[parent]
        k = parent
    keys[k], items[k] = key, item
    return keys, items


@register_jitable(no_cfunc_wrapper=True)
def pop(keys, items, size):
    """Remove the smallest; the caller reads entry 0 before and decreases `size` itself."""
    key, item = keys[size - 1], items[size - 1]
    size -= 1
    k = 0
    while True:
        child = 2 * k + 1
        if child >= size:
            break
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[k], items[k] = keys[child], items[child]
        k = child
    if size > 0:
        keys[k], items[k] = key, item
