"""Heights that grow over a patch of columns (numba kernel), as ``getHeightData`` of Recast."""

from numba import njit


@njit(cache=True, nogil=True)
def grow(neighbours, x, z, floor, patch, x_low, z_low, unset, queue, end):
    """Carry heights on to what can be walked to from spans whose heights are known.

    Args:
        neighbours: Span in each of the four directions; negative where there is none.
        x: Column of every span along x.
        z: Column of every span along z.
        floor: Height of every span.
        patch: Heights by column z and column x; written.
        x_low: Column along x of the first entry.
        z_low: Column along z of the first entry.
        unset: What stands where no height is known.
        queue: The spans to begin with, and room for as many as the patch has entries.
        end: Number of the first.
    """
    head = 0
    while head < end:
        i = queue[head]
        head += 1
        for direction in range(4):
            beside = neighbours[i, direction]
            if beside < 0:
                continue
            row, column = z[beside] - z_low, x[beside] - x_low
            inside = 0 <= row < patch.shape[0] and 0 <= column < patch.shape[1]
            if inside and patch[row, column] == unset:
                patch[row, column] = floor[beside]
                queue[end] = beside
                end += 1
