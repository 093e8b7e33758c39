"""Random furnished rooms and a robot that drives in them, without a renderer."""

import math

import cv2
import numpy as np

from hypernav.core.embodiment import Action
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2

_FINE = 4
"""The truth is four times finer than the map."""


def random_rooms(rng: np.random.Generator, *, door_m: float, furniture: int = 12) -> OccupancyGrid:
    """Four rooms of a 10 m square with a door between each two of them, completely known."""
    side, door = 200, round(door_m / 0.05)
    cells = np.full((side, side), Cell.FREE, np.uint8)
    cells[:2] = cells[-2:] = cells[:, :2] = cells[:, -2:] = Cell.OCCUPIED
    row, column = rng.integers(70, 130, 2)
    cells[row : row + 2] = cells[:, column : column + 2] = Cell.OCCUPIED
    for low, high, wall in ((5, column, 0), (column + 5, side, 0), (5, row, 1), (row + 5, side, 1)):
        first = rng.integers(low, high - 5 - door)
        if wall == 0:
            cells[row : row + 2, first : first + door] = Cell.FREE
        else:
            cells[first : first + door, column : column + 2] = Cell.FREE
    for _ in range(furniture):
        height, width = rng.integers(2, 20, 2)
        y, x = rng.integers(2, side - 22, 2)
        cells[y : y + height, x : x + width] = Cell.OCCUPIED
    return OccupancyGrid(cells, 0.05, (-3.3, -4.1))


def random_clutter(rng: np.random.Generator, *, furniture: int = 14) -> OccupancyGrid:
    """A hall of 8 m with furniture at some angle to the map, completely known; free at (0, 0)."""
    side = 160
    cells = np.full((side, side), Cell.FREE, np.uint8)
    y, x = (np.indices((side, side)) + 0.5) * 0.05 - 4.0
    angle = rng.uniform(0.0, math.pi / 2.0)
    along = x * math.cos(angle) + y * math.sin(angle)
    across = y * math.cos(angle) - x * math.sin(angle)
    for _ in range(furniture):
        middle, half = rng.uniform(-3.0, 3.0, 2), rng.uniform(0.2, 1.2, 2)
        if (np.abs(middle) >= half + 0.2).any():
            inside = (np.abs(along - middle[0]) < half[0]) & (np.abs(across - middle[1]) < half[1])
            cells[inside] = Cell.OCCUPIED
    cells[[0, -1]] = cells[:, [0, -1]] = Cell.OCCUPIED
    return OccupancyGrid(cells, 0.05, (-4.0, -4.0))


class DrivenRobot:
    """Turns and steps as ordered; a step ends where the robot's disc would touch an obstacle."""

    def __init__(self, grid: OccupancyGrid, pose: Pose2, *, radius_m: float = 0.18) -> None:
        fine = np.kron(grid.occupied.astype(np.uint8), np.ones((_FINE, _FINE), np.uint8))
        self._cell_m = grid.resolution_m / _FINE
        away = cv2.distanceTransform(1 - fine, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        self._clearance_m = (away - 0.5) * self._cell_m
        self._radius_m = radius_m
        self._origin = grid.origin
        self.pose = pose
        self.bumps = 0
        self.travelled_m = 0.0

    def fits(self, x: float, y: float) -> bool:
        row = int((y - self._origin[1]) / self._cell_m)
        column = int((x - self._origin[0]) / self._cell_m)
        return bool(self._clearance_m[row, column] >= self._radius_m)

    def do(self, action: Action, *, forward_m: float = 0.5, turn_deg: float = 30.0) -> None:
        x, y, yaw = self.pose.x, self.pose.y, self.pose.yaw
        if action is Action.MOVE_FORWARD:
            steps = round(forward_m / 0.01)
            dx, dy = forward_m / steps * math.cos(yaw), forward_m / steps * math.sin(yaw)
            gone = 0
            while gone < steps and self.fits(x + dx * (gone + 1), y + dy * (gone + 1)):
                gone += 1
            self.bumps += gone < steps
            self.travelled_m += gone * forward_m / steps
            self.pose = Pose2(x + dx * gone, y + dy * gone, yaw)
        else:
            turn = math.radians(turn_deg) * (1 if action is Action.TURN_LEFT else -1)
            self.pose = Pose2(x, y, yaw + turn)
