"""What a scenario of the real sea may say: wind, vessel, reports, sensors, faults, and what is drawn by lot."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from scenarios.schema.config import Guidance, Histories, Keepout, NonNegative, Positive, Section, check_divides

_DESIGNED_FOR = ("guidance.", "plume.source_height_m")

Angle = Annotated[float, Field(ge=-360.0, le=360.0)]
Range = tuple[float, float]


def check_ordered(name: str, values: Range) -> None:
    """Raise a ValueError unless the first of ``values``, called ``name``, is at most the second."""
    if values[0] > values[1]:
        raise ValueError(f"{name} is {list(values)}; its first value must not exceed its second")


class Manoeuvre(Section):
    """A change of the vessel's course or speed, at a steady rate."""

    at_s: NonNegative
    """When it begins [s]."""
    turn_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    """Change of course, positive to starboard [deg]."""
    turn_rate_deg_s: Annotated[float, Field(gt=0.0, le=5.0)] = 0.5
    """Rate of the turn [deg/s]."""
    speed_mps: Annotated[float, Field(ge=0.0, le=30.0)] | None = None
    """Speed over the ground that it ends with; that before if not given [m/s]."""
    acceleration_mps2: Annotated[float, Field(gt=0.0, le=1.0)] = 0.05
    """Rate of the change of speed [m/s2]."""


class SeaVessel(Section):
    """The ship."""

    speed_mps: Annotated[float, Field(ge=0.0, le=300.0)] = 8.0
    """Speed over the ground, before any manoeuvre [m/s]."""
    course_deg: Angle = 0.0
    """Course, clockwise from north [deg]."""
    manoeuvres: tuple[Manoeuvre, ...] = ()
    """What it does, one after the other."""

    @model_validator(mode="after")
    def _in_turn(self) -> "SeaVessel":
        times = [m.at_s for m in self.manoeuvres]
        if times != sorted(times):
            raise ValueError(f"manoeuvres begin at {times} s; put them in their order")
        return self


class Wind(Section):
    """The steady wind."""

    speed_mps: Annotated[float, Field(ge=0.0, le=40.0)] = 0.0
    """Wind speed [m/s]."""
    from_deg: Angle = 0.0
    """Where it comes from, clockwise from north [deg]."""


class Turbulence(Section):
    """Turbulence of MIL-F-8785C, and discrete gusts."""

    level: Literal["none", "light", "moderate", "severe"] = "none"
    """Light, moderate and severe are 15, 30 and 45 knots of wind at 20 feet."""
    gusts: Annotated[int, Field(ge=0, le=100)] = 0
    """Number of 1-cosine gusts, at random times and from random directions."""
    gust_speed_mps: NonNegative = 0.0
    """Their largest speed [m/s]."""
    gust_length_s: Positive = 4.0
    """How long each takes to rise, and to fall [s]."""


class SeaPlume(Section):
    """The axis of the smoke plume: a half-line from the funnel."""

    direction: Literal["apparent_wind", "given"] = "apparent_wind"
    """Behind the vessel's motion through the air, or, as in the paper, a free parameter."""
    heading_deg: Angle = 180.0
    """Direction from the bow, where it is given [deg]."""
    source_height_m: Annotated[float, Field(ge=10.0, le=500.0)] = 60.0
    """Height of the funnel's mouth above the sea, at which the UAV flies [m]."""


class Reports(Section):
    """What the vessel says of itself, as AIS does."""

    interval_s: tuple[NonNegative, NonNegative] = (0.0, 0.0)
    """Shortest and longest time between reports; 0 for exact knowledge at all times [s]."""
    position_sigma_m: NonNegative = 5.0
    """Error of each coordinate of a report, one sigma [m]."""
    velocity_sigma_mps: NonNegative = 0.15
    """Error of each component of the velocity, one sigma [m/s]."""
    latency_max_s: NonNegative = 0.0
    """Longest time from when a report is true to when it is heard [s]."""
    missing: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    """Share of reports that are never heard [-]."""

    @model_validator(mode="after")
    def _ordered(self) -> "Reports":
        check_ordered("interval_s", self.interval_s)
        return self

    @property
    def exact(self) -> bool:
        """Return whether the vessel's motion is known at all times."""
        return self.interval_s[1] == 0.0


class Sensors(Section):
    """Errors of the UAV's sensors; none unless they are given. Biases are drawn for each flight, within these limits."""

    position_sigma_m: NonNegative = 0.0
    """Error of each coordinate by satellite navigation, one sigma, wandering with a time constant of a minute [m]."""
    velocity_sigma_mps: NonNegative = 0.0
    """Noise of each velocity component by satellite navigation [m/s]."""
    airspeed_sigma_mps: NonNegative = 0.0
    """Noise of the airspeed [m/s]."""
    airspeed_bias_mps: NonNegative = 0.0
    """Largest bias of the airspeed [m/s]."""
    heading_sigma_deg: NonNegative = 0.0
    """Noise of the heading [deg]."""
    heading_bias_deg: NonNegative = 0.0
    """Largest bias of the heading [deg]."""


class Fault(Section):
    """What fails in flight."""

    kind: Annotated[str, Field(pattern=r"^[a-z_0-9]+$")] = "none"
    """none, vessel_data, satellite_navigation, engine, or the name of an actuator of the aircraft (see the error for another)."""
    at_s: tuple[NonNegative, NonNegative] = (100.0, 250.0)
    """Earliest and latest time; drawn in between [s]."""
    vessel_data_s: Positive = 60.0
    """For how long vessel data are gone [s]."""
    satellite_navigation_s: Positive = 10.0
    """For how long satellite navigation is gone [s]; anything else is gone for good."""

    @model_validator(mode="after")
    def _ordered(self) -> "Fault":
        check_ordered("at_s", self.at_s)
        return self


class Following(Section):
    """How the reference follows a vessel over a real sea, beyond what the paper's guidance says."""

    touches_per_hour: Annotated[float, Field(gt=0.0, lt=1.0)] = 1e-4
    """Chance of touching r_min per flight hour that the keep-out margin is planned for [1/h]."""
    margin_min_m: NonNegative = 3.0
    """Smallest keep-out margin, in calm air and with exact knowledge [m]."""
    speed_ratio_max: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.97
    """Speed ratio from which a vessel counts as one that outruns the UAV [-]."""
    apparent_wind_min_mps: Positive = 1.0
    """Apparent wind below which a plume has no direction that could be known [m/s]."""
    standoff_m: Positive = 100.0
    """How much further off than r_CO the centre of oscillation stays until the UAV tracks its reference [m]."""
    join_distance_m: Positive = 150.0
    """Distance from the centre of oscillation at which the way there ends and tracking begins [m]."""
    tracked_m: Positive = 12.0
    """Distance from the reference that counts as tracked: the centre closes in [m]."""
    vessel_acceleration_mps2: NonNegative = 0.0
    """Largest acceleration of the vessel that the keep-out guard allows for, and that a silent vessel may have [m/s2]."""
    speed_error_mps: NonNegative = 0.0
    """Error of the relative speed that the keep-out guard allows for [m/s]."""
    drift_rate_mps: NonNegative = 1.0
    """How fast dead reckoning may go wrong without satellite navigation [m/s]."""


class SeaStart(Section):
    """Where flights begin: a seeded random place about the vessel, on any course."""

    distance_m: tuple[Positive, Positive] = (400.0, 800.0)
    """Nearest and farthest distance from the vessel [m]."""
    spread_deg: Annotated[float, Field(ge=0.0, le=180.0)] = 180.0
    """Largest bearing from the plume's axis, either side [deg]."""
    range_m: Positive | None = None
    """Distance from the vessel; random within distance_m if not given [m]."""
    aspect_deg: Angle | None = None
    """Bearing from the plume's axis, clockwise; random within spread_deg if not given [deg]."""
    course_deg: Angle | None = None
    """Course through the air; any if not given [deg]."""


class SeaFlight(Section):
    """When a flight ends and what is recorded."""

    crossings: Annotated[int, Field(ge=0, le=10_000)] = 30
    """Crossings to fly after settling; 0 to fly for the whole duration [-]."""
    duration_max_s: Annotated[float, Field(gt=0.0, le=100_000.0)] = 900.0
    """Longest flight [s]."""
    settling_band_m: Positive = 8.0
    """Settled once the reference is nearer than this, and its orbit nearer to its place than three times this, for a period [m]."""
    log_rate_hz: Annotated[float, Field(ge=5.0, le=120.0)] = 10.0
    """Recording rate [Hz], at least 5 so that keep-out figures are true to centimetres; must divide the guidance rate."""


class SeaCriteria(Section):
    """What a flight must show to count as met, beside keeping out; none where a key is left out."""

    settles: bool = True
    """Whether it must settle, and fly what crossings are asked for."""
    crossing_interval_error: Positive | None = None
    """Largest relative difference of the mean crossing interval from pi/omega_0 [-]."""
    tracking_error_rms_m: Positive | None = None
    """Largest rms distance to the reference after settling [m]."""
    resumes_within_periods: Positive | None = None
    """Largest time from the end of the last manoeuvre to the next crossing, in periods of the oscillation [-]."""
    modes_at_end: tuple[str, ...] = ()
    """Modes in which it may end; any if empty."""


class Draw(Section):
    """A key that is drawn for each flight, from one distribution."""

    key: str
    """Dotted key of the scenario; a number is a place in a list, as in vessel.manoeuvres.0.turn_deg."""
    uniform: Range | None = None
    """Drawn evenly between these."""
    normal: tuple[float, Positive] | None = None
    """Mean and standard deviation."""
    weibull: tuple[Positive, Positive] | None = None
    """Shape and scale, as wind speeds have them."""
    within: Range | None = None
    """What a normal or Weibull distribution is cut off at."""
    choice: Annotated[tuple[object, ...], Field(min_length=1)] | None = None
    """One of these. Dealt in turn, so that each comes equally often, or drawn by their weights."""
    weights: tuple[NonNegative, ...] | None = None
    """Of the choices, in any unit."""

    @model_validator(mode="after")
    def _one(self) -> "Draw":
        given = [name for name in ("uniform", "normal", "weibull", "choice") if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                f"draw of '{self.key}' has {' and '.join(given) or 'none'} of uniform, normal, weibull and choice; give one"
            )
        for name in ("uniform", "within"):
            if (values := getattr(self, name)) is not None:
                check_ordered(f"{name} of the draw of '{self.key}'", values)
        if self.within is not None and given[0] not in ("normal", "weibull"):
            raise ValueError(f"draw of '{self.key}' has within beside {given[0]}; it cuts off a normal or a weibull")
        if self.weights is not None and (self.choice is None or len(self.weights) != len(self.choice) or not sum(self.weights)):
            raise ValueError(f"draw of '{self.key}' has weights {list(self.weights)}; give each choice one, and not all 0")
        return self


class SeaScenario(Section):
    """A trial over the real sea.

    Of ``guidance``, tuning and bound_speed_margin_mps, placement, phase_deg and tracking_allowance_m, airspeed_trim and what
    belongs to it, and command_limit have no effect: the reference is steered, its distance planned with ``following``, its pace
    held.
    """

    study: Literal["sea"] = "sea"
    title: str
    description: str = ""
    aircraft: Annotated[str, Field(coerce_numbers_to_str=True)] = "x8"
    fidelity: Literal["six_dof", "kinematic"] = "six_dof"
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = 1
    flights: Annotated[int, Field(ge=1, le=1_000_000)] = 1
    histories: Histories = 200
    flight_seed: Annotated[int, Field(ge=0, le=2**63 - 1)] | None = None
    """Of start, air and noise; each flight has its own, from seed, name and number, if it is not given."""
    speed_ratio: Range = (0.0, 1e9)
    """Flights whose nu leaves this range, at the start or after a manoeuvre, are drawn again [-]."""
    draws: tuple[Draw, ...] = ()
    vessel: SeaVessel = SeaVessel()
    wind: Wind = Wind()
    turbulence: Turbulence = Turbulence()
    plume: SeaPlume = SeaPlume()
    keepout: Keepout = Keepout()
    reports: Reports = Reports()
    sensors: Sensors = Sensors()
    fault: Fault = Fault()
    guidance: Guidance = Guidance()
    following: Following = Following()
    start: SeaStart = SeaStart()
    flight: SeaFlight = SeaFlight()
    criteria: SeaCriteria = SeaCriteria()

    @model_validator(mode="after")
    def _consistent(self) -> "SeaScenario":
        check_divides("flight.log_rate_hz", self.flight.log_rate_hz, self.guidance.rate_hz)
        check_ordered("start.distance_m", self.start.distance_m)
        check_ordered("speed_ratio", self.speed_ratio)
        if self.start.distance_m[0] <= self.keepout.radius_m:
            raise ValueError(
                f"start.distance_m begins at {self.start.distance_m[0]:g} m; it must exceed keepout.radius_m,"
                f" {self.keepout.radius_m:g} m"
            )
        if self.start.range_m is not None and self.start.range_m <= self.keepout.radius_m:
            raise ValueError(
                f"start.range_m is {self.start.range_m:g} m; it must exceed keepout.radius_m, {self.keepout.radius_m:g} m"
            )
        air, room = self.turbulence, self.flight.duration_max_s
        if self.fault.kind != "none" and self.fault.at_s[1] >= room:
            raise ValueError(
                f"fault.at_s ends at {self.fault.at_s[1]:g} s; it must lie within flight.duration_max_s, {room:g} s:"
                " fly longer, or let it fail earlier"
            )
        if (air.gusts > 0) != (air.gust_speed_mps > 0.0):
            raise ValueError(
                f"turbulence.gusts is {air.gusts} with a turbulence.gust_speed_mps of {air.gust_speed_mps:g}; give both, or neither"
            )
        if air.gusts * 2.0 * air.gust_length_s > 0.9 * room:
            raise ValueError(
                f"turbulence.gusts is {air.gusts}, each {2.0 * air.gust_length_s:g} s long; they do not fit into"
                f" flight.duration_max_s, {room:g} s: give fewer or shorter ones"
            )
        if self.fidelity == "kinematic" and (air.level != "none" or air.gusts):
            raise ValueError(
                "turbulence.level or turbulence.gusts is set with fidelity 'kinematic', which feels the steady wind alone:"
                " set fidelity to 'six_dof', or turbulence.level to 'none' and turbulence.gusts to 0"
            )
        keys = [draw.key for draw in self.draws]
        for key in keys:
            if key.startswith(_DESIGNED_FOR):
                raise ValueError(
                    f"draws has '{key}', for which autopilot and margins are worked out once; give each value a run of its own"
                )
            if keys.count(key) > 1:
                raise ValueError(f"draws has '{key}' {keys.count(key)} times; draw a key once")
            if "." not in key and key != "flight_seed":
                raise ValueError(f"draws has '{key}', which is the trial's own; draw keys of its sections, as in wind.speed_mps")
        return self


class SeaTrial(Section):
    """A list of trials, flown and reported together."""

    study: Literal["sea_trial"] = "sea_trial"
    title: str
    description: str = ""
    trials: Annotated[tuple[str, ...], Field(min_length=1)]
    """Scenarios of the real sea, by their names in the catalog or their paths."""
    share: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0
    """Share of each trial's flights that are flown, for a quick look [-]."""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] | None = None
    """Seed of every trial; each has its own if not given."""
    histories: Histories = 350
    set: tuple[str, ...] = ()
    """Keys to set in every trial, as key=value; overrides of the command line that are not keys of this list come here."""
