"""The sections of a scenario file on equipment: the vessel's reports, sensors, faults, payload.
Equipment that is absent is ideal.
"""

import functools
from typing import Annotated, Any, ClassVar

from pydantic import (
    ConfigDict,
    Field,
    TypeAdapter,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    field_validator,
    model_validator,
)

from scenarios.scenario.extension_points import PAYLOADS
from scenarios.scenario.sections.needs import OPERATIONAL, Need, when
from scenarios.scenario.sections.part_section import PartSection
from scenarios.scenario.sections.section import NonNegative, Positive, Section, check_ordered

REPORTS_MAX = 200_000
"""Most reports in a flight: four times those of the longest flight by AIS, every 2 s at its
fastest; with 0.4 kB each, 80 MB.
"""


_NOW_AND_THEN = Need(
    lambda s: not s.vessel_known, "reports that come now and then: set reports.interval_s"
)


_OFF_THE_STACK = Need(
    lambda s: (
        (s.vessel.hull is not None and s.vessel.hull.antenna_distance > 0.0)
        or (s.vessel.from_file and s.vessel.stack_from_bow_m is not None)
    ),
    "an antenna that is not at the funnel: set vessel.antenna_from_bow_m",
)


class VesselReportsConfig(Section):
    """Reports of the vessel's motion, as by AIS."""

    NEEDS: ClassVar[tuple[Need, ...]] = (OPERATIONAL,)

    interval_s: tuple[NonNegative, NonNegative] = (0.0, 0.0)
    """Shortest and longest time between reports; 0 for exact knowledge at all times [s]."""
    position_sigma_m: Annotated[NonNegative, _NOW_AND_THEN] = 5.0
    """Error of each coordinate of a report, one sigma [m]."""
    velocity_sigma_mps: Annotated[NonNegative, _NOW_AND_THEN] = 0.15
    """Error of each component of the velocity, one sigma [m/s]."""
    heading_sigma_deg: Annotated[NonNegative, _NOW_AND_THEN, _OFF_THE_STACK] = 0.5
    """Error of the ship's heading in a report, one sigma; with it the place of the antenna is taken
    to the funnel. In a file the course stands for the heading, with its own error besides [deg]."""
    turn_rate_sigma_deg_s: Annotated[NonNegative, _NOW_AND_THEN, _OFF_THE_STACK] = 0.02
    """Error of the rate of turn in a report, one sigma [deg/s]."""
    latency_max_s: Annotated[NonNegative, _NOW_AND_THEN] = 0.0
    """Longest delay between the time that a report states and its reception [s]."""
    missing: Annotated[float, Field(ge=0.0, lt=1.0), _NOW_AND_THEN] = 0.0
    """Fraction of reports that are never received [-]."""

    @model_validator(mode="after")
    def _ordered(self) -> "VesselReportsConfig":
        check_ordered("interval_s", self.interval_s)
        return self

    @property
    def exact(self) -> bool:
        """Return whether the vessel's motion is known at all times."""
        return self.interval_s[1] == 0.0


class SensorsConfig(Section):
    """Errors of the UAV's sensors. Biases are sampled for each flight, within these limits."""

    NEEDS: ClassVar[tuple[Need, ...]] = (OPERATIONAL,)

    position_sigma_m: NonNegative = 0.0
    """Error of each coordinate of satellite navigation, one sigma; it drifts with a time constant
    of a minute [m].
    """
    velocity_sigma_mps: NonNegative = 0.0
    """Noise of each velocity component of satellite navigation [m/s]."""
    airspeed_sigma_mps: NonNegative = 0.0
    """Noise of the airspeed [m/s]."""
    airspeed_bias_mps: NonNegative = 0.0
    """Largest bias of the airspeed [m/s]."""
    heading_sigma_deg: NonNegative = 0.0
    """Noise of the heading [deg]."""
    heading_bias_deg: NonNegative = 0.0
    """Largest bias of the heading [deg]."""


class FaultConfig(Section):
    """A fault in flight; several, each at a time of its own, as a list of tables, [[fault]]."""

    NEEDS: ClassVar[tuple[Need, ...]] = (OPERATIONAL,)

    kind: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.\-]+$")] = "none"
    """Kind of fault: none, vessel_data, satellite_navigation, sniffer_dead, sniffer_saturated,
    engine, or the name of an actuator of the aircraft (the error message for an unknown name lists
    them)."""
    at_s: Annotated[
        tuple[NonNegative, NonNegative],
        when("fault.kind", user="a fault"),
        Field(json_schema_extra={"type": ["array", "number"], "minimum": 0.0}),
    ] = (100.0, 250.0)
    """Earliest and latest time of the fault, which is sampled in between; or one number, the time
    itself [s].
    """
    vessel_data_s: Annotated[
        Positive,
        when("fault.kind", "vessel_data", user="a loss of vessel data"),
    ] = 60.0
    """How long vessel data are lost [s]."""
    satellite_navigation_s: Annotated[
        Positive,
        when("fault.kind", "satellite_navigation", user="a loss of satellites"),
    ] = 10.0
    """How long satellite navigation is lost [s]; any other fault lasts to the end of the flight."""
    declared: tuple[str, ...] = ()
    """Kinds of fault that the keep-out guard and its margin allow for, besides the flight's own and
    those swept or sampled.
    """

    @field_validator("at_s", mode="before")
    @classmethod
    def _one_time(cls, given: Any) -> Any:
        """Accept a number as a range with only this value, so that a random variable can set the
        time.
        """
        return (
            (given, given)
            if isinstance(given, int | float) and not isinstance(given, bool)
            else given
        )

    @model_validator(mode="after")
    def _ordered(self) -> "FaultConfig":
        check_ordered("at_s", self.at_s)
        return self


@functools.cache
def _several() -> TypeAdapter[tuple[FaultConfig, ...]]:
    return TypeAdapter(tuple[FaultConfig, ...])


def _one_or_several(given: Any, _: ValidatorFunctionWrapHandler) -> Any:
    """Return a fault, or several from a list; an error message names the key in the form that the
    user has given.
    """
    if isinstance(given, list | tuple):
        return _several().validate_python(given)
    return FaultConfig.model_validate(given)


OneOrSeveralFaults = Annotated[
    FaultConfig | tuple[FaultConfig, ...], WrapValidator(_one_or_several)
]


class PayloadConfig(PartSection):
    """The instruments on board; each may add keys of its own."""

    model_config = ConfigDict(
        json_schema_extra={"type": ["object", "array"], "items": {"type": "string"}}
    )

    NAMED_IN: ClassVar[str] = "payload.instruments"

    instruments: tuple[str, ...] = ()
    """Instruments, each by its name, such as sniffer, or FILE.py:NAME; their readings are columns
    of the time history.
    """

    @model_validator(mode="before")
    @classmethod
    def _names_alone(cls, given: Any) -> Any:
        """Accept a list as the names of the instruments, without any settings."""
        return {"instruments": given} if isinstance(given, list | tuple) else given

    def parts(self) -> dict[str, Any]:
        """Return the instruments by their names."""
        return {name: PAYLOADS.get(name) for name in self.instruments}


class KinematicConfig(Section):
    """The paper's vehicle, eq. (1)."""

    NEEDS: ClassVar[tuple[Need, ...]] = (
        when("fidelity", "kinematic", "both", user="the kinematic vehicle"),
    )

    heading_rate_lag_s: NonNegative = 0.0
    """Time constant of the heading rate behind its command; 0 for eq. (1) as it stands [s]."""
