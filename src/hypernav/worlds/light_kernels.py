"""Sums of the rays that measure how much light reaches a place. Compiled."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def gather_light(distances, directions, sky, reach_m, floor, result):
    """Light from each of the six sides of every place.

    Args:
        distances: To the first thing along every direction, float32 [directions, places];
            negative or over `reach_m` where it is farther.
        directions: Unit vectors, float32 [directions, 3].
        sky: Light that arrives from every direction where nothing is in the way, [directions].
        reach_m: A thing this far away takes no light.
        floor: What a thing that touches the place leaves of the light, 0 to 1.
        result: Filled with light from +x, -x, +y, -y, +z, -z, uint8 [places, 6].
    """
    sums = np.zeros(6)
    for place in range(distances.shape[1]):
        sums[:] = 0.0
        for ray in range(distances.shape[0]):
            distance = distances[ray, place]
            near = distance / reach_m if 0.0 <= distance < reach_m else 1.0
            light = sky[ray] * (floor + (1.0 - floor) * near)
            for axis in range(3):
                along = directions[ray, axis]
                if along > 0.0:
                    sums[2 * axis] += light * along
                else:
                    sums[2 * axis + 1] -= light * along
        # The directions are spread evenly: the cosines of one half sum up to a quarter of them.
        scale = 4.0 / distances.shape[0] * 255.0
        for side in range(6):
            result[place, side] = np.uint8(min(sums[side] * scale + 0.5, 255.0))
