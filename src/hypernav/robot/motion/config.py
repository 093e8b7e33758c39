"""Limits of a robot's velocity, and how closely it follows a path."""

import math

from pydantic import Field

from hypernav.core.config import RoomConfig


class DriveConfig(RoomConfig):
    """Limits of a robot's velocity, and how closely it follows a path. All values are ours.

    Attributes:
        max_speed_m_s: Largest speed forward, metres per second; it never drives backward.
        max_turn_rate_deg_s: Largest rate of rotation, degrees per second.
        max_acceleration_m_s2: Largest change of the speed, metres per second squared. Only an
            obstacle that has newly appeared is braked for harder.
        max_turn_acceleration_deg_s2: Largest change of the rate of rotation, degrees per second
            squared.
        look_ahead_m: Distance along the path of the point that it steers to, metres.
        corner_cut_m: Largest distance by which it leaves the path at a corner, metres.
        turn_in_place_deg: Angle off the heading beyond which it rotates on the spot, degrees.
        margin_m: Distance that the body keeps from obstacles, metres. Paths through narrow gaps
            need 0 (`hypernav.planning.config.PlanningConfig.squeeze_m`); people who walk need more.
        reaction_s: Time for which a command may stay in force beyond its own duration before the
            robot brakes for an obstacle, seconds: images are late, links fail. The robot slows
            down near obstacles accordingly.
        slow_within_m: Distance between body and obstacles below which it drives slower, metres.
        slowest_share: Share of the largest speed that remains at zero distance to an obstacle.
        arrival_m: Distance from the end of the path at which it has arrived, metres.
    """

    max_speed_m_s: float = Field(default=0.5, gt=0.0, le=5.0)
    max_turn_rate_deg_s: float = Field(default=60.0, gt=0.0, le=720.0)
    max_acceleration_m_s2: float = Field(default=0.5, gt=0.0, le=20.0)
    max_turn_acceleration_deg_s2: float = Field(default=180.0, gt=0.0, le=7200.0)
    look_ahead_m: float = Field(default=0.5, gt=0.0, le=5.0)
    corner_cut_m: float = Field(default=0.03, gt=0.0, le=1.0)
    turn_in_place_deg: float = Field(default=30.0, gt=0.0, le=90.0)
    margin_m: float = Field(default=0.0, ge=0.0, le=1.0)
    reaction_s: float = Field(default=0.0, ge=0.0, le=5.0)
    slow_within_m: float = Field(default=0.4, gt=0.0, le=5.0)
    slowest_share: float = Field(default=0.3, gt=0.0, le=1.0)
    arrival_m: float = Field(default=0.05, gt=0.0, le=5.0)

    @property
    def max_turn_rate(self) -> float:
        """Largest rate of rotation, radians per second."""
        return math.radians(self.max_turn_rate_deg_s)

    @property
    def max_turn_acceleration(self) -> float:
        """Largest change of the rate of rotation, radians per second squared."""
        return math.radians(self.max_turn_acceleration_deg_s2)
