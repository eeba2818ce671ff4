"""The sections of a scenario file on a flight: its start, its end, and its criteria."""

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from common.text import did_you_mean
from gnc.mission.mission import Mode
from scenarios.scenario.sections.needs import EXHAUST, SNIFFER, VESSEL, Need, when
from scenarios.scenario.sections.section import (
    Angle,
    Limit,
    NonNegative,
    Positive,
    Section,
    check_ordered,
)

ALTITUDE_MIN = 5.0
"""Least altitude at the start [m]: a few metres lower a wing that is banked in a turn reaches the
sea.
"""

DITCHED = "ditched"
"""Mode of a flight whose guidance, because of a fault, descended to the water: its aircraft is
lost.
"""


ALTITUDE_MARGIN = {"none": 3.0, "light": 6.0, "moderate": 10.0, "severe": 15.0}
"""How far within the limits of the altitude is flown, by the turbulence [m]."""


class StartConfig(Section):
    """Where flights begin: at a given place and on a given course, or at random places about the
    plume's axis on any course.
    """

    distance_m: Annotated[
        tuple[Positive, Positive],
        Need(
            lambda s: s.start.place_m is None and s.start.range_m is None,
            "a random distance: leave out start.place_m and start.range_m",
        ),
    ] = (400.0, 800.0)
    """Smallest and largest distance from the vessel, which is sampled in between [m]."""
    spread_deg: Annotated[
        float,
        Field(ge=0.0, le=180.0),
        Need(
            lambda s: s.start.place_m is None and s.start.aspect_deg is None,
            "a random bearing: leave out start.place_m and start.aspect_deg",
        ),
    ] = 30.0
    """Largest bearing from the plume's axis, to either side [deg]."""
    range_m: Positive | None = None
    """Distance from the vessel; random within distance_m if not given [m]."""
    aspect_deg: Angle | None = None
    """Bearing from the plume's axis, clockwise; random within spread_deg if not given [deg]."""
    course_deg: Angle | None = None
    """Course through the air; random if not given [deg]."""
    place_m: tuple[float, float] | None = None
    """Place ahead and right of the vessel or, on a circle, of the reference's start; random if not
    given [m].
    """

    @model_validator(mode="after")
    def _ordered(self) -> "StartConfig":
        check_ordered("distance_m", self.distance_m)
        if self.place_m is not None and (self.range_m is not None or self.aspect_deg is not None):
            raise ValueError(
                "place_m is given beside range_m or aspect_deg; give the place in one way"
            )
        return self


class FlightConfig(Section):
    """When a flight ends and what is recorded."""

    crossings: Annotated[
        int,
        Field(ge=0, le=10_000),
        VESSEL,
    ] = 30
    """Crossings to fly after settling; 0 to fly for the whole duration [-]."""
    after_settling_s: Annotated[Positive | None, VESSEL] = None
    """Time to fly after settling, and at least until the crossings are complete; only crossings
    count if not given [s].
    """
    measured_s: Annotated[
        Positive | None,
        when("payload.instruments", user="instruments"),
    ] = None
    """Time before the end of the flight over which instruments are evaluated, settled or not; from
    settling on if not given [s].
    """
    duration_max_s: Annotated[
        float,
        Field(gt=0.0, le=100_000.0),
    ] = 1500.0
    """Longest flight [s]; gusts, reports and the noise of sensors and exhaust are sampled for the
    whole of it, so another value changes them from the start on, with the same seed, too."""
    until: Annotated[Literal["flown", "verdict"], SNIFFER] = "flown"
    """When the flight ends: flown, with its crossings and its duration; verdict, also once the
    sniffer's readings allow a verdict on the fuel, or cannot any more."""
    altitude_m: Annotated[
        float | None,
        Field(ge=ALTITUDE_MIN),
        Need(
            lambda s: s.follows and not s.stands_off,
            "the mission that follows the vessel; the others fly at the height of the plume: set"
            " guidance.mission to 'follow'",
        ),
    ] = None
    """Altitude at the start, for which the autopilot is designed; if not given, the height of the
    funnel's mouth, beside a ship with exhaust 3 m or more within altitude_min_m and altitude_max_m
    [m]."""
    altitude_min_m: Annotated[NonNegative, EXHAUST] = 20.0
    """Lowest altitude at which rising exhaust is crossed, and a flight beside it starts: of what is
    commanded; a search stays 3 to 15 m away from it, by the turbulence [m]."""
    altitude_max_m: Annotated[Positive, EXHAUST] = 120.0
    """Highest altitude at which rising exhaust is crossed, and a flight beside it starts, likewise
    [m].
    """
    settling_band_m: Positive = 5.0
    """Distance to the reference below which a flight counts as settled [m]."""
    log_rate_hz: Annotated[float, Field(ge=5.0, le=120.0)] = 10.0
    """Recording rate [Hz], at least 5; must divide the guidance rate. Keep-out figures are true to
    5 cm: a kinematic vehicle that turns too fast for it is refused."""

    @model_validator(mode="after")
    def _altitudes(self) -> "FlightConfig":
        if self.altitude_min_m >= self.altitude_max_m:
            raise ValueError(
                f"altitude_min_m is {self.altitude_min_m:g} m and altitude_max_m"
                f" {self.altitude_max_m:g} m; the first must be the lower one"
            )
        return self

    @model_validator(mode="after")
    def _long_enough(self) -> "FlightConfig":
        if self.duration_max_s < (least := 1.0 / self.log_rate_hz):
            raise ValueError(
                f"duration_max_s is {self.duration_max_s:g} s; at log_rate_hz,"
                f" {self.log_rate_hz:g} Hz, nothing is recorded in less than {least:g} s"
            )
        return self

    def altitudes_kept(self, turbulence: str) -> tuple[float, float]:
        """Return the lowest and the highest altitude that leave turbulence of a level its room
        within the limits [m].
        """
        margin = ALTITUDE_MARGIN[turbulence]
        return self.altitude_min_m + margin, self.altitude_max_m - margin

    def altitude_beside(self, height: float, turbulence: str) -> float:
        """Return the altitude that is kept, in turbulence of a level, nearest to the height of a
        funnel with exhaust [m].
        """
        lowest, highest = self.altitudes_kept(turbulence)
        return min(max(height, lowest), highest) if lowest < highest else 0.5 * (lowest + highest)


Pair = Annotated[
    tuple[Positive, Positive] | None,
    Field(json_schema_extra={"type": ["array", "boolean"], "not": {"enum": [True]}}),
]
"""A least and a largest value, or ``false`` where the quantity is not judged."""

_PAIRS = ("crossing_interval_s", "crossing_distance_m")
"""Criteria of a least and a largest value."""


_SETTLES = when("criteria.settles", user="flights that must settle")


class CriteriaConfig(Section):
    """Criteria of a flight, in addition to keeping out and completing its mission; ``false`` for
    what is not judged.
    """

    required: Literal["criteria", "keep_out"] = "criteria"
    """What exit status 0 requires of the flight: to meet every criterion, or only to keep out, as
    in tests of faults.
    """
    settles: bool = True
    """Whether tracking, airspeed and altitude are judged after settling; a flight beside a vessel
    must settle in either case.
    """
    tracking_error_rms_m: Annotated[Limit, _SETTLES] = 1.5
    """Largest rms distance to the reference after settling [m]."""
    airspeed_error_rms_mps: Annotated[Limit, _SETTLES] = 0.3
    """Largest rms difference of airspeed from its command [m/s]."""
    altitude_error_max_m: Annotated[Limit, _SETTLES] = 1.5
    """Largest difference of altitude from its command [m]."""
    crossing_interval_error: Annotated[Limit, VESSEL] = 0.01
    """Largest relative difference of the mean crossing interval from pi/omega_0 [-]."""
    tracking_error_end_m: Limit = False
    """Largest distance to the reference at the end [m]."""
    crossing_interval_s: Annotated[Pair, VESSEL] = None
    """Least and largest mean crossing interval, or ``false`` [s]."""
    crossing_distance_m: Annotated[Pair, VESSEL] = None
    """Least and largest mean crossing distance from the vessel, or ``false`` [m]."""
    law_beyond_heading_rate_max: bool = False
    """Whether the law must command more than omega_max, to show that it does; how commands are
    limited is then not judged.
    """
    law_within_heading_rate_max: bool = False
    """Whether the law itself, before commands are limited, must not command more than omega_max."""
    resumes_within_periods: Annotated[
        Limit,
        Need(
            lambda s: s.vessel.manoeuvres or s.vessel.track != "manoeuvres",
            "a vessel that manoeuvres: set vessel.manoeuvres or vessel.track",
        ),
    ] = False
    """Largest time from the end of the last manoeuvre to the next crossing, in periods of the
    oscillation [-].
    """
    time_to_find_s: Annotated[Limit, SNIFFER] = False
    """Largest time from reaching the orbit to the first reading of the plume [s]."""
    within_altitudes: Annotated[bool, SNIFFER] = False
    """Whether altitude must stay within flight.altitude_min_m and altitude_max_m, except that of an
    aircraft with a fault.
    """
    modes_at_end: Annotated[tuple[str, ...], VESSEL] = ()
    """Modes in which the flight may end; any if empty."""

    @model_validator(mode="before")
    @classmethod
    def _not_judged(cls, given: Any) -> Any:
        """Accept ``false`` as None where a list of two is expected."""
        if not isinstance(given, dict):
            return given
        return {
            key: None if key in _PAIRS and value is False else value for key, value in given.items()
        }

    @model_validator(mode="after")
    def _ordered(self) -> "CriteriaConfig":
        for name in _PAIRS:
            check_ordered(name, getattr(self, name))
        return self

    @field_validator("modes_at_end")
    @classmethod
    def _known(cls, modes: tuple[str, ...]) -> tuple[str, ...]:
        known = [*(mode.value for mode in Mode), DITCHED]
        for mode in modes:
            if mode not in known:
                meant = did_you_mean(mode, known) or ";"
                raise ValueError(f"'{mode}' is not a mode{meant} modes are {', '.join(known)}")
        return modes
