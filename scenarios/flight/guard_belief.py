"""The guard's estimates and allowances, for the record: after the flight the premises of its
theorem are checked against them (``scenarios.measures.premises``).
"""

import math

from common.columns import described
from gnc.estimation.error_budget import STILL, WindErrorByGusts
from gnc.estimation.navigation import MeasuredMotion
from gnc.guard.guard import KeepoutGuard
from gnc.guidance import Guidance
from scenarios.world.vessel import VesselTruth

_EXACT_WIND = WindErrorByGusts(STILL)


class GuardBelief:
    """A guard's estimates and allowances, as columns of the time history.

    Parameters
    ----------
    guidance, guard : of the flight
    vessel : true motion of the vessel; the recorded disc is the one of the guard's discs in which
        the vessel has least room
    time_step : of the guidance [s]
    """

    COLUMNS = described(
        {
            "own_seen_north_m": "place of the UAV over the ground, as the guidance estimates it",
            "own_seen_east_m": "place of the UAV over the ground, as the guidance estimates it",
            "own_seen_course_rad": (
                "course of the UAV through the mean air, as the guidance estimates it"
            ),
            "own_seen_speed_mps": (
                "speed of the UAV through the mean air, as the guidance estimates it"
            ),
            "satellites_lost_s": "time since satellite navigation was lost, 0 while it works",
            "wind_allowance_mps": "error of the wind allowed for while few measurements are in it",
            "gust_in_wind_mps": "standard deviation of the estimated wind by gusts",
            "gust_in_wind_covariance_m2_s2": "covariance of that error with the gust of the moment",
            "gust_in_wind_gain_per_s": "share of that error that a second of measurements corrects",
            "disc_north_m": (
                "centre of the disc in which the vessel has least room, of those of the guard"
            ),
            "disc_east_m": (
                "centre of the disc in which the vessel has least room, of those of the guard"
            ),
            "disc_radius_m": "radius of that disc",
            "speed_fastest_mps": "fastest speed through the mean air that the guard predicts with",
            "speed_slowest_mps": "slowest speed through the mean air that the guard predicts with",
            "command_change": (
                "largest recent change of command over a full reversal, as the guard has it"
            ),
            "course_commanded_rad": "integral of the commanded heading rate over the mean air",
        }
    )

    def __init__(
        self, guidance: Guidance, guard: KeepoutGuard, vessel: VesselTruth, time_step: float
    ) -> None:
        self._guidance = guidance
        self._guard = guard
        self._vessel = vessel
        self._time_step = time_step
        self._commanded = 0.0

    def command(self, heading_rate: float) -> None:
        """Record the heading rate over the mean air that is flown for a step [rad/s]."""
        self._commanded += self._time_step * heading_rate

    def read(
        self,
        time: float,
        motion: MeasuredMotion,  # noqa: ARG002 - of an instrument
        sample: tuple[float, ...],  # noqa: ARG002 - of an instrument
    ) -> tuple[float, ...]:
        """Return a value for each column."""
        own = self._guidance.own
        gusts = own.wind_by_gusts or _EXACT_WIND
        reckoning = self._guard.reckoning
        return (
            own.ground_north,
            own.ground_east,
            own.course,
            own.speed,
            own.lost,
            own.wind_error,
            gusts.sigma,
            gusts.covariance,
            gusts.gain,
            *self._tightest_disc(time),
            reckoning.fastest,
            reckoning.slowest,
            reckoning.change,
            self._commanded,
        )

    def _tightest_disc(self, time: float) -> tuple[float, float, float]:
        """Return centre and radius of the disc in which the vessel has least room [m]."""
        vessel_north, vessel_east = (float(value) for value in self._vessel.motion(time)[:2])
        least, tightest = math.inf, (math.nan, math.nan, math.nan)
        for disc in self._guidance.target.tubes:
            since = time - disc.time
            north = disc.north + disc.velocity_north * since
            east = disc.east + disc.velocity_east * since
            radius = disc.reach(since)
            room = radius - math.hypot(vessel_north - north, vessel_east - east)
            if room < least:
                least, tightest = room, (north, east, radius)
        return tightest
