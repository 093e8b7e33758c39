"""Segmentation without weights, by box or point: a cut by depth, then by colour."""

from dataclasses import dataclass, field

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32

from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation
from hypernav.search.perception.config import DepthCutConfig

_SAME_DEPTH_M = 0.2
"""Distance in depth from the object's largest part within which its other parts lie."""
_SMALLEST_SHARE = 0.02
"""Share of the box below which a part is too small to be the object."""
_LEAST_INSIDE = 0.5
"""`_Parts.inside` from which on a part may be one of the object's other parts."""
_LEAST_FIT = 0.02
"""Least factor on the fit of a part, that of one that extends far beyond the box."""
_NEAREST_M = 0.3  # depth below which nearer parts fit no better
_WORK_SIZE_PX = 120
"""Length that the longer side of the box is reduced to before the colour cut."""
_MARGIN = 0.15
"""Width of the certain background around the box, as a share of the box's size."""
_ITERATIONS = 2
"""Number of GrabCut's iterations."""
_POINT_REACH_M = 1.0
"""Distance from a point within which the object at it is taken to end."""
_POINT_REACH_PX = 4.0
"""Distance from a point up to which another pixel may stand in for it."""
_MAX_FLOOR_SHARE = 0.6
"""Share of the box on the floor above which the object lies on it, as a rug does, and the floor is
kept."""
_MAX_EMPTY_SHARE = 0.5
"""Share of the box without depth above which the object is taken to lie beyond the range of depth,
behind whatever has depth there."""


@dataclass(frozen=True, eq=False)
class DepthCutSegmenter:
    """GrabCut inside the box, seeded by the part of the depth image that fits the box best.

    Jumps in depth divide the image into parts. A box is tight, so the object's part reaches from
    one side of it to the other, and unlike a wall behind or a table before, it ends there. Pixels
    of that part are probable foreground, pixels outside the box certain background, and the colour
    models of GrabCut (Rother et al., 2004; OpenCV's ``grabCut``) decide the rest.

    Attributes:
        config: Configuration of the depth cut.
    """

    config: DepthCutConfig = field(default_factory=DepthCutConfig)

    def segment(self, observation: Observation, box: Box) -> Bool[np.ndarray, "height width"]:
        """The object's pixels, in the depth image's size; all False if the box is outside it."""
        height, width = observation.depth.shape
        mask = np.zeros((height, width), dtype=bool)
        box = box.clipped(width, height)
        if box.area < 1.0:
            return mask
        dx, dy = (
            _MARGIN * (box.x_max - box.x_min),
            _MARGIN * (box.y_max - box.y_min),
        )
        crop = Box(box.x_min - dx, box.y_min - dy, box.x_max + dx, box.y_max + dy)
        x0, y0, x1, y1 = crop.clipped(width, height).pixels()
        scale = min(1.0, _WORK_SIZE_PX / max(x1 - x0, y1 - y0))
        size = (max(round((x1 - x0) * scale), 2), max(round((y1 - y0) * scale), 2))
        rgb = cv2.resize(observation.rgb[y0:y1, x0:x1], size, interpolation=cv2.INTER_AREA)
        depth = cv2.resize(observation.depth[y0:y1, x0:x1], size, interpolation=cv2.INTER_NEAREST)
        inside = np.zeros(depth.shape, dtype=bool)
        bx0, by0, bx1, by1 = box.pixels()
        sx, sy = size[0] / (x1 - x0), size[1] / (y1 - y0)
        top, left = round((by0 - y0) * sy), round((bx0 - x0) * sx)
        bottom = max(round((by1 - y0) * sy), top + 1)  # a thin box keeps a row when it is reduced
        right = max(round((bx1 - x0) * sx), left + 1)
        inside[top:bottom, left:right] = True
        floor = self._is_floor(observation, depth, (x0, y0), (sx, sy))
        if (floor & inside).sum() > _MAX_FLOOR_SHARE * inside.sum():
            floor[:] = False
        cut = self._cut(rgb, depth, inside, floor)
        whole = cv2.resize(
            cut.astype(np.uint8), (x1 - x0, y1 - y0), interpolation=cv2.INTER_NEAREST
        )
        mask[y0:y1, x0:x1] = whole.astype(bool)
        return mask

    def segment_point(
        self, observation: Observation, x: float, y: float
    ) -> Bool[np.ndarray, "height width"]:
        """The part of the depth image that is connected with a point, within 1 m of it.

        A wall behind that is no farther than `DepthCutConfig.depth_gap_m` belongs to it. Where the
        point has no depth, the nearest pixel with depth in a small square around it counts.

        Args:
            observation: Frame that the point was given in.
            x: Coordinate to the right, pixels.
            y: Coordinate down, pixels.

        Returns:
            The pixels; all False where there is no depth at the point.
        """
        depth = observation.depth
        rows, columns = np.arange(depth.shape[0])[:, None], np.arange(depth.shape[1])[None, :]
        has_depth = is_measured(depth)
        away = np.maximum(np.abs(rows + 0.5 - y), np.abs(columns + 0.5 - x))
        away[~has_depth] = np.inf
        at = np.unravel_index(away.argmin(), depth.shape)
        if away[at] > _POINT_REACH_PX:
            return np.zeros(depth.shape, dtype=bool)
        floor = self._is_floor(observation, depth, (0, 0), (1.0, 1.0))
        labels = _divided(depth, has_depth & (floor == floor[at]), self.config.depth_gap_m)
        points = observation.camera.unproject_pixels(rows, columns, depth)
        near = np.linalg.norm(points - points[at], axis=-1) <= _POINT_REACH_M
        return (labels == labels[at]) & near

    def _is_floor(
        self,
        observation: Observation,
        depth: Float32[np.ndarray, "h w"],
        corner: tuple[int, int],
        scale: tuple[float, float],
    ) -> Bool[np.ndarray, "h w"]:
        """Pixels of the reduced crop whose points lie on the floor of the ``map`` frame."""
        columns = corner[0] + (np.arange(depth.shape[1]) + 0.5) / scale[0]
        rows = corner[1] + (np.arange(depth.shape[0]) + 0.5) / scale[1]
        points = observation.camera.unproject(columns[None, :], rows[:, None], depth)
        height = observation.camera_to_map.apply(points.reshape(-1, 3))[:, 2].reshape(depth.shape)
        return is_measured(depth) & (height < self.config.floor_height_m)

    def _cut(
        self,
        rgb: np.ndarray,
        depth: Float32[np.ndarray, "h w"],
        box: Bool[np.ndarray, "h w"],
        floor: Bool[np.ndarray, "h w"],
    ) -> Bool[np.ndarray, "h w"]:
        """The object's pixels in a reduced crop."""
        inside, has_depth = box & ~floor, is_measured(depth)
        empty = inside & ~has_depth
        if empty.sum() > _MAX_EMPTY_SHARE * inside.sum():
            return empty
        cluster = self._best_fitting_parts(depth, box, has_depth & ~floor)
        if not cluster.any():
            return inside
        labels = np.where(inside, cv2.GC_PR_BGD, cv2.GC_BGD).astype(np.uint8)
        labels[inside & ~has_depth] = cv2.GC_PR_FGD
        labels[cluster] = cv2.GC_PR_FGD
        if not (labels == cv2.GC_BGD).any() and not (labels == cv2.GC_PR_BGD).any():
            return cluster
        cv2.setRNGSeed(0)  # GrabCut clusters colours at random: the same image, the same cut
        cv2.grabCut(
            np.ascontiguousarray(rgb),
            labels,
            (0, 0, 0, 0),  # unused: the mask says where the object is
            np.zeros((1, 65)),
            np.zeros((1, 65)),
            _ITERATIONS,
            cv2.GC_INIT_WITH_MASK,
        )
        cut = (labels == cv2.GC_FGD) | (labels == cv2.GC_PR_FGD)
        # Colour may leak into a background of the same colour; depth may not.
        cut &= cluster | ~has_depth
        return cut if cut.sum() * 4 >= cluster.sum() else cluster

    def _best_fitting_parts(
        self,
        depth: Float32[np.ndarray, "h w"],
        box: Bool[np.ndarray, "h w"],
        solid: Bool[np.ndarray, "h w"],
    ) -> Bool[np.ndarray, "h w"]:
        """The pixels in the box of the part that fits it best, and of other parts at its depth.

        Args:
            depth: Depth, metres.
            box: Pixels in the box; those around it tell which parts end there.
            solid: Pixels with depth that are not floor.
        """
        parts = _Parts.of(_divided(depth, solid, self.config.depth_gap_m), depth, box)
        if not parts.inside.any():
            return np.zeros_like(box)
        best = int(parts.fit.argmax())
        ends = depth[(parts.labels == best) & box]
        low, high = np.percentile(ends, [2, 98])
        belongs = (parts.depth >= low - _SAME_DEPTH_M) & (parts.depth <= high + _SAME_DEPTH_M)
        belongs &= parts.inside >= _LEAST_INSIDE
        belongs[0], belongs[best] = False, True
        return belongs[parts.labels] & box


@dataclass(frozen=True, eq=False)
class _Parts:
    """The parts of a depth image and how they fit a box; part 0 holds what belongs to none.

    Attributes:
        labels: Number of every pixel's part.
        depth: Mean depth of every part, metres.
        inside: How much of every part lies in the box: 1 if all of it does, 0 if no larger share
            than of the whole crop does, or nothing.
        fit: How well every part fits the box; -1 if it is too small to be the object.
    """

    labels: Int32[np.ndarray, "h w"]
    depth: Float64[np.ndarray, " parts"]
    inside: Float64[np.ndarray, " parts"]
    fit: Float64[np.ndarray, " parts"]

    @staticmethod
    def of(
        labels: Int32[np.ndarray, "h w"],
        depth: Float32[np.ndarray, "h w"],
        box: Bool[np.ndarray, "h w"],
    ) -> "_Parts":
        """Measure the parts."""
        count = int(labels.max()) + 1
        pixels = np.bincount(labels.ravel(), minlength=count)
        within = np.bincount(labels[box], minlength=count)
        within[0] = 0
        mean = np.bincount(labels.ravel(), depth.ravel(), count) / np.maximum(pixels, 1)
        around = max(1.0 - float(box.mean()), 1e-3)
        inside = np.clip(1.0 - (1.0 - within / np.maximum(pixels, 1)) / around, 0.0, 1.0)
        inside[within == 0] = 0.0
        share = within / max(int(within.sum()), 1)
        # The nearer of two equal parts hides the farther one.
        fit = _span(labels, box, count) * (_LEAST_FIT + inside) * np.sqrt(share)
        fit /= np.sqrt(np.maximum(mean, _NEAREST_M))
        fit[share < _SMALLEST_SHARE] = -1.0
        return _Parts(labels, mean, inside, fit)


def _divided(
    depth: Float32[np.ndarray, "h w"], solid: Bool[np.ndarray, "h w"], gap_m: float
) -> Int32[np.ndarray, "h w"]:
    """Number of every pixel's part; 0 where a pixel is not solid.

    Neighbouring pixels belong to one part if their depths differ by less than the gap. Between
    neighbours a pixel is inserted that says whether they are linked, so that OpenCV finds parts.
    """
    height, width = depth.shape
    links = np.zeros((2 * height - 1, 2 * width - 1), dtype=np.uint8)
    links[::2, ::2] = solid
    across = np.abs(np.diff(depth, axis=1)) < gap_m
    links[::2, 1::2] = across & solid[:, 1:] & solid[:, :-1]
    down = np.abs(np.diff(depth, axis=0)) < gap_m
    links[1::2, ::2] = down & solid[1:] & solid[:-1]
    _, labels = cv2.connectedComponents(links, connectivity=4, ltype=cv2.CV_32S)
    return np.ascontiguousarray(labels[::2, ::2])


def _span(
    labels: Int32[np.ndarray, "h w"], box: Bool[np.ndarray, "h w"], count: int
) -> Float64[np.ndarray, " parts"]:
    """Share of the box that the rectangle around every part's pixels in the box covers."""
    rows, columns = np.nonzero(box)
    numbers = labels[box]
    span = np.ones(count)
    for values in (rows, columns):
        low, high = np.full(count, values.max() + 1), np.full(count, values.min() - 1)
        np.minimum.at(low, numbers, values)
        np.maximum.at(high, numbers, values)
        span *= np.maximum(high - low + 1, 0) / (values.max() - values.min() + 1)
    return span
