"""Box-prompted segmentation without weights: a cut by depth, then by colour."""

import cv2
import numpy as np
from jaxtyping import Bool, Float32
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.depth import is_measured
from hypernav.core.observation import Observation

_BIN_M = 0.10


class DepthCutConfig(RoomConfig):
    """Configuration of the depth cut, which replaces the paper's MobileSAM; its values are ours.

    Attributes:
        work_size_px: Length that the longer side of the box is reduced to before the colour cut,
            pixels.
        margin: Width of the certain background around the box, as a share of the box's size.
        depth_gap_m: Jump in depth that ends the object, metres.
        iterations: Number of GrabCut's iterations.
        floor_height_m: Height below which a pixel is floor, not the object, metres: floor touches
            the object without a jump in depth and often has its colour. 0 keeps it.
        max_empty_share: Share of the box without depth above which the object lies beyond the range
            of depth, and what has depth stands before it.
        max_floor_share: Share of the box on the floor above which the object lies on it (a rug),
            and the floor is kept.
    """

    work_size_px: int = Field(default=120, ge=16, le=4096)
    margin: float = Field(default=0.15, ge=0.0, le=1.0)
    depth_gap_m: float = Field(default=0.30, gt=0.0, le=100.0)
    iterations: int = Field(default=2, ge=1, le=100)
    floor_height_m: float = Field(default=0.06, ge=0.0, le=10.0)
    max_floor_share: float = Field(default=0.6, ge=0.0, le=1.0)
    max_empty_share: float = Field(default=0.5, ge=0.0, le=1.0)


class DepthCutSegmenter:
    """GrabCut inside the box, seeded by the dominant depth cluster.

    The object is taken to be the nearest large cluster of depth around the middle of the box;
    pixels in it are probable foreground, pixels outside the box certain background, and the colour
    models of GrabCut (Rother et al., 2004; OpenCV's ``grabCut``) decide the rest.
    """

    def __init__(self, config: DepthCutConfig | None = None) -> None:
        """Create the segmenter."""
        self._config = config or DepthCutConfig()

    def segment(self, observation: Observation, box: Box) -> Bool[np.ndarray, "height width"]:
        """The object's pixels; all False if the box lies outside the image."""
        height, width = observation.depth.shape
        mask = np.zeros((height, width), dtype=bool)
        box = box.clipped(width, height)
        if box.area < 1.0:
            return mask
        dx, dy = (
            self._config.margin * (box.x_max - box.x_min),
            self._config.margin * (box.y_max - box.y_min),
        )
        crop = Box(box.x_min - dx, box.y_min - dy, box.x_max + dx, box.y_max + dy)
        x0, y0, x1, y1 = crop.clipped(width, height).pixels()
        scale = min(1.0, self._config.work_size_px / max(x1 - x0, y1 - y0))
        size = (max(round((x1 - x0) * scale), 2), max(round((y1 - y0) * scale), 2))
        rgb = cv2.resize(observation.rgb[y0:y1, x0:x1], size, interpolation=cv2.INTER_AREA)
        depth = cv2.resize(observation.depth[y0:y1, x0:x1], size, interpolation=cv2.INTER_NEAREST)
        inside = np.zeros(depth.shape, dtype=bool)
        bx0, by0, bx1, by1 = box.pixels()
        sx, sy = size[0] / (x1 - x0), size[1] / (y1 - y0)
        inside[
            round((by0 - y0) * sy) : max(round((by1 - y0) * sy), 1),
            round((bx0 - x0) * sx) : max(round((bx1 - x0) * sx), 1),
        ] = True
        floor = inside & self._is_floor(observation, depth, (x0, y0), (sx, sy))
        if floor.sum() <= self._config.max_floor_share * inside.sum():
            inside &= ~floor
        cut = self._cut(rgb, depth, inside)
        whole = cv2.resize(
            cut.astype(np.uint8), (x1 - x0, y1 - y0), interpolation=cv2.INTER_NEAREST
        )
        mask[y0:y1, x0:x1] = whole.astype(bool)
        return mask

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
        return is_measured(depth) & (height < self._config.floor_height_m)

    def _cut(
        self,
        rgb: np.ndarray,
        depth: Float32[np.ndarray, "h w"],
        inside: Bool[np.ndarray, "h w"],
    ) -> Bool[np.ndarray, "h w"]:
        has_depth = is_measured(depth)
        empty = inside & ~has_depth
        if empty.sum() > self._config.max_empty_share * inside.sum():
            return empty
        cluster = inside & self._dominant_cluster(depth, inside)
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
            self._config.iterations,
            cv2.GC_INIT_WITH_MASK,
        )
        cut = (labels == cv2.GC_FGD) | (labels == cv2.GC_PR_FGD)
        # Colour may leak into a background of the same colour; depth may not.
        cut &= cluster | ~has_depth
        return cut if cut.sum() * 4 >= cluster.sum() else cluster

    def _dominant_cluster(
        self, depth: Float32[np.ndarray, "h w"], inside: Bool[np.ndarray, "h w"]
    ) -> Bool[np.ndarray, "h w"]:
        rows, columns = np.nonzero(inside)
        middle = np.zeros_like(inside)
        top, bottom = np.percentile(rows, [20, 80]).astype(int)
        left, right = np.percentile(columns, [20, 80]).astype(int)
        middle[top : bottom + 1, left : right + 1] = True
        has_depth = is_measured(depth)
        values = depth[middle & inside & has_depth]
        if values.size == 0:
            return np.zeros_like(inside)
        counts = np.bincount((values / _BIN_M).astype(int))
        # Nearer things hide farther ones, so of two equal clusters the nearer is the object.
        weight = counts / (1.0 + 0.1 * np.arange(counts.size) * _BIN_M)
        peak = int(weight.argmax())
        all_counts = np.bincount((depth[inside & has_depth] / _BIN_M).astype(int))
        floor = max(1.0, 0.02 * float(all_counts.max()))
        low, high = self._grow(all_counts, peak, floor)
        return (depth >= low * _BIN_M) & (depth < (high + 1) * _BIN_M) & has_depth

    def _grow(self, counts: np.ndarray, peak: int, floor: float) -> tuple[int, int]:
        """Widen the peak over neighbouring depths until a gap."""
        gap = max(1, round(self._config.depth_gap_m / _BIN_M))
        low = high = peak
        while low > 0 and (counts[max(low - gap, 0) : low] > floor).any():
            low -= 1
        while high + 1 < counts.size and (counts[high + 1 : high + 1 + gap] > floor).any():
            high += 1
        return low, high
