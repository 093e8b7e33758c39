"""Evidence of things for the kinds of rooms around them, compiled."""

import math

import numpy as np
from numba import njit

_MOST_ROUNDS = 6
"""Sweeps over a window and back: paths that wind more are not worth another."""


@njit(cache=True, nogil=True)
def path_costs(step_costs, seeds, most):
    """Least costs of 8-connected paths from any of some patches to every patch near them.

    Args:
        step_costs: float64 (rows, columns), cost of a step into a patch.
        seeds: int64 (n, 2), rows and columns of the patches to begin with; others are left out.
        most: Cost up to which patches are reached.

    Returns:
        float64 (rows, columns), infinite where no such path leads.
    """
    rows, columns = step_costs.shape
    cost = np.full((rows, columns), np.inf)
    low_row, high_row, low_column, high_column = rows, 0, columns, 0
    span = int(most) + 1
    for k in range(len(seeds)):
        row, column = seeds[k]
        if 0 <= row < rows and 0 <= column < columns:
            cost[row, column] = 0.0
            low_row, high_row = min(low_row, row - span), max(high_row, row + span)
            low_column, high_column = (
                min(low_column, column - span),
                max(high_column, column + span),
            )
    low_row, high_row = max(low_row, 1), min(high_row, rows - 2)
    low_column, high_column = max(low_column, 1), min(high_column, columns - 2)
    for _ in range(_MOST_ROUNDS):
        changed = False
        for sweep in (1, -1):  # upwards with what lies below, then downwards with what lies above
            for i in range(high_row - low_row + 1):
                row = low_row + i if sweep > 0 else high_row - i
                for j in range(high_column - low_column + 1):
                    column = low_column + j if sweep > 0 else high_column - j
                    before = row - sweep
                    straight = min(cost[before, column], cost[row, column - sweep])
                    diagonal = min(cost[before, column - 1], cost[before, column + 1])
                    step = step_costs[row, column]
                    there = min(straight + step, diagonal + step * math.sqrt(2.0))
                    if there <= most and there < cost[row, column] - 1e-6:
                        cost[row, column] = there
                        changed = True
        if not changed:
            break
    return cost


@njit(cache=True, nogil=True)
def evidence(step_costs, seeds, thing_of, here, beside, at, same_room, next_room, sure):
    """Likelihoods of the kinds of rooms at some patches, given the things around.

    A thing stands in the same room as a patch, in the room beside, or anywhere, and the farther
    the path the less likely the first two.

    Args:
        step_costs: float64 (rows, columns), cost of a step into a patch.
        seeds: int64 (n, 2), patches where things stand.
        thing_of: int64 (n,), which of the things stands there.
        here: float64 (things, kinds), likelihood of a thing in a room of a kind, over the average.
        beside: float64 (things, kinds), the same of a thing in a room beside one of a kind.
        at: int64 (m, 2), rows and columns of the patches that are asked about.
        same_room: Cost of a path at which a thing is half as likely in the same room as at first.
        next_room: The same for the same room or the one beside.
        sure: Probability that a thing at hand is what it is called, and stands in this room.

    Returns:
        float64 (m, kinds), likelihoods over the average.
    """
    likelihoods = np.ones((len(at), here.shape[1]))
    for thing in range(len(here)):
        cost = path_costs(step_costs, seeds[thing_of == thing], 1.5 * next_room)
        for i in range(len(at)):
            away = cost[at[i, 0], at[i, 1]]
            if away < np.inf:
                same = sure / (1.0 + (away / same_room) ** 4)
                near = sure / (1.0 + (away / next_room) ** 4) - same
                for kind in range(here.shape[1]):
                    likelihoods[i, kind] *= (
                        same * here[thing, kind] + near * beside[thing, kind] + 1.0 - same - near
                    )
    return likelihoods
