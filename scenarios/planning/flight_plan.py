"""One flight, resolved to SI."""

import math
from dataclasses import dataclass
from typing import Any

from common.hull import ShipHull
from gnc.estimation.vessel import VesselReport
from gnc.guidance import GuidanceParameters
from gnc.reference.reference import PeriodicPath
from scenarios.planning.guidance import Steering
from scenarios.planning.limits import omega_max
from scenarios.planning.margin.keepout_margin import KeepoutMargin
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.world import Shape
from scenarios.vehicles.sensors import SensorErrors
from scenarios.world.world import ApparentWind, World


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensing:
    """The sensors and reports of the guidance, where it does not know everything exactly.

    Attributes
    ----------
    received : reports of the vessel and the time at which each is received [s]; None where the
        vessel is known exactly
    errors : of the sensors
    traffic : for each of the other ships, the same as ``received``
    reads_plume, knows_axis : whether a sniffer is read in flight, and whether the guidance knows
        the plume's true axis
    """

    received: list[tuple[float, VesselReport]] | None
    errors: SensorErrors
    traffic: tuple[list[tuple[float, VesselReport]] | None, ...] = ()
    reads_plume: bool = False
    knows_axis: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """Place and course at the start of a flight.

    Attributes
    ----------
    north, east : [m]
    course : through the air [rad]
    """

    north: float
    east: float
    course: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightPlan:
    """One flight: guidance, world, sensing, start, and end. A part that is None is absent.

    Attributes
    ----------
    flight_id : unique in the run
    guidance : parameters of the outer loop
    steering : of the law's look-ahead, and the bound on its demand
    start : of the UAV
    keepout_shape, keepout_radius : a sphere about the plume's origin or an upright cylinder through
        it, and its r_min [m]
    keepout_hull : outline from which r_min is measured; None where it is measured from the funnel
    guarded_radius : distance from the funnel that keeps out of the area at any heading of the ship
        [m]
    speed_ratio_max : largest speed ratio at which a vessel is followed [-]
    heading_rate_max : omega_max, whether commands are cut at it or not [rad/s]
    duration_max, crossings : longest duration, and number of crossings, of the flight [s, -]
    after_settling : time of flight after settling; infinite without an end [s]
    settling_band, settling_period : distance from the reference to stay within, and for how long,
        to be settled [m, s]
    log_interval : of the record, in guidance steps
    payload : instruments on board
    until_verdict : whether it leaves as soon as the readings of a sniffer give a verdict
    nu : speed ratio at the start; NaN without a vessel [-]
    world : vessel, plume, air, faults; None where the reference circles without a vessel
    sensing : sensors and reports; None where everything is known exactly
    oscillation : of the reference at that ratio
    periods : of the oscillation at equal steps of nu from 0 to ``speed_ratio_max``, where the
        reference is steered [s]
    centre_distance : r_CO where it is fixed, else NaN [m]
    margin : planned on top of r_min, where the reference is steered
    apparent_wind : of the vessel, where the reference is steered
    """

    flight_id: str
    guidance: GuidanceParameters
    steering: Steering
    start: Start
    keepout_shape: Shape
    keepout_radius: float
    keepout_hull: ShipHull | None
    guarded_radius: float
    speed_ratio_max: float
    heading_rate_max: float
    duration_max: float
    crossings: int
    after_settling: float
    settling_band: float
    settling_period: float
    log_interval: int
    payload: tuple[str, ...]
    until_verdict: bool = False
    nu: float = math.nan
    world: World | None = None
    sensing: Sensing | None = None
    oscillation: PeriodicPath | None = None
    periods: tuple[float, ...] = ()
    centre_distance: float = math.nan
    margin: KeepoutMargin | None = None
    apparent_wind: ApparentWind | None = None

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        flight_id: str,
        *,
        guidance: GuidanceParameters,
        steering: Steering,
        start: Start,
        period: float,
        **parts: Any,
    ) -> "FlightPlan":
        """Return the plan of a scenario's flight; ``parts`` are the parts that not every flight
        has.
        """
        flight, g = scenario.flight, scenario.guidance
        return cls(
            flight_id=flight_id,
            guidance=guidance,
            steering=steering,
            start=start,
            keepout_shape=scenario.keepout.shape,
            keepout_radius=scenario.keepout.radius_m,
            keepout_hull=scenario.vessel.hull if scenario.keepout.from_hull else None,
            guarded_radius=scenario.guarded_radius,
            speed_ratio_max=scenario.following.speed_ratio_max,
            heading_rate_max=omega_max(g),
            duration_max=flight.duration_max_s,
            crossings=flight.crossings,
            after_settling=math.inf if flight.after_settling_s is None else flight.after_settling_s,
            settling_band=flight.settling_band_m,
            settling_period=period,
            log_interval=round(g.rate_hz / flight.log_rate_hz),
            payload=scenario.payload.instruments,
            until_verdict=flight.until == "verdict",
            **parts,
        )

    @property
    def time_step(self) -> float:
        """Return the time step of the guidance [s]."""
        return self.guidance.tracking.time_step

    @property
    def altitude(self) -> float:
        """Return the altitude at the start [m]."""
        return self.guidance.altitude

    @property
    def source_height(self) -> float:
        """Return the height of the plume's origin above the sea, where the centre of a keep-out
        sphere lies [m].
        """
        return self.world.source_height if self.world else self.guidance.altitude

    def period(self, nu: float) -> float:
        """Return the period of the oscillation at a speed ratio [s]."""
        if not self.periods:
            return self.oscillation.period if self.oscillation else math.nan
        steps = len(self.periods) - 1
        return self.periods[min(round(nu / self.speed_ratio_max * steps), steps)]
