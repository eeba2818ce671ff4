"""What a scenario file may say. Units are in the names; bounds are checked here and nowhere else."""

import math
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator


def check_divides(name: str, rate: float, whole: float) -> None:
    """Raise a ValueError unless ``rate`` [Hz], called ``name``, divides ``whole`` [Hz]."""
    ratio = whole / rate
    if abs(ratio - round(ratio)) > 1e-9:
        fitting = [n for n in range(1, int(whole) + 1) if whole % n == 0.0]
        nearest = min(fitting, key=lambda n: abs(n - rate))
        raise ValueError(f"{name} is {rate:g} Hz; it must divide {whole:g} Hz, e.g. {nearest}")


class Section(BaseModel):
    """Frozen; unknown keys and numbers that are not finite are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True)


Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Histories = Annotated[int, Field(ge=0, le=100_000)]
"""Number of time histories to be kept: an even sample. Those of flights that fall short are kept beside them."""


class Sweep(Section):
    """What varies from flight to flight."""

    nu: Annotated[tuple[Annotated[float, Field(ge=0.0, le=10.0)], ...], Field(min_length=1, max_length=1000)]
    """Speed ratios, vessel over UAV [-]. Ratios of 1 and above are infeasible and become rows that say so."""


class Vessel(Section):
    """The ship, at constant velocity; its speed is nu times that of the UAV."""

    course_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    """Course, clockwise from north [deg]."""


class Plume(Section):
    """The axis of the smoke plume: a half-line from the funnel."""

    heading_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 180.0
    """Direction chi_P, clockwise from the vessel's bow [deg]; 180 is straight astern."""
    elevation_deg: Annotated[float, Field(ge=0.0, le=60.0)] = 0.0
    """Elevation alpha_P above the horizon [deg]."""
    source_height_m: Annotated[float, Field(ge=10.0, le=500.0)] = 60.0
    """Height of the funnel's mouth above the sea, where the axis starts [m]."""


class Keepout(Section):
    """The sphere about the funnel's mouth that the UAV must not enter."""

    radius_m: Annotated[float, Field(ge=10.0, le=10_000.0)] = 200.0
    """r_min [m]."""


class Kinematic(Section):
    """The paper's vehicle, eq. (1). Of no effect on the aircraft in six degrees of freedom."""

    heading_rate_lag_s: NonNegative = 0.0
    """Time constant of the heading rate behind its command; 0 for eq. (1) as it stands [s]."""


class Reference(Section):
    """What the reference point does.

    On a circle there is no vessel: vessel, plume (but for its height), keepout and what shapes the oscillation have no effect, and
    no crossings are counted.
    """

    path: Literal["oscillation", "circle"] = "oscillation"
    """Oscillate about a centre in the plume, eq. (2), or circle without a vessel, as in the paper's Sims. 1 and 2."""
    radius_m: Positive = 130.0
    """Radius of the circle, flown to the right [m]."""


class Guidance(Section):
    """The paper's outer loop."""

    law: Literal["cascade", "lyapunov", "line_of_sight"] = "cascade"
    """Steering law: eq. (30), eq. (24), or the line-of-sight baseline."""
    airspeed_mps: Annotated[float, Field(ge=5.0, le=300.0)] = 19.42
    """V_r, speed of the reference and of the UAV [m/s]; the aircraft's own unless it is given."""
    bank_deg: Annotated[float, Field(gt=0.0, le=60.0)] = 45.0
    """Bank whose coordinated turn sets omega_max = g tan(bank)/V_r [deg]; the aircraft's own unless it is given."""
    heading_rate_max_rad_s: Positive | None = None
    """omega_max given directly [rad/s]; overrides bank_deg."""
    reserve: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.015
    """Fraction of omega_max that the reference leaves to feedback [-]; the paper leaves none."""
    roll_rate_max_deg_s: Annotated[float, Field(gt=0.0, le=360.0)] = 40.0
    """Roll rate that the reference may ask for [deg/s]."""
    phase_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    """Oscillation phase phi_0 [deg]."""
    placement: Literal["paper", "exact"] = "paper"
    """Rule for r_CO: eq. (10), or the smallest for which the whole orbit stays outside."""
    tracking_allowance_m: Annotated[float, Field(ge=0.0, le=10_000.0)] = 1.0
    """Added to r_min in the placement: what the UAV may stray from the reference. The guard adds three quarters of it [m]."""
    tuning: Literal["given", "bounded"] = "given"
    """Look-ahead and steering_max as given, or those that converge fastest while no state asks for more than omega_max."""
    bound_speed_margin_mps: NonNegative = 0.5
    """The bound on commands holds while the aircraft's speed exceeds the largest commanded airspeed by no more than this [m/s]."""
    epsilon_per_m: Positive = 0.005
    """epsilon of the look-ahead, eq. (15) [1/m]; of no effect with bounded tuning."""
    look_ahead_m: Positive = 60.0
    """R of the look-ahead, eq. (15) [m]; above 1/(4 epsilon); of no effect with bounded tuning."""
    gain_per_s: Positive = 1.5
    """Slope of h(phi) in eq. (30), and gain of the line-of-sight law [1/s]."""
    steering_max_rad_s: Positive = 0.4
    """Largest |h(phi)| in eq. (30) [rad/s]; of no effect with bounded tuning."""
    lyapunov_gain_per_m2: Positive = 0.001
    """k_1 of eq. (24) [1/m2]."""
    command_limit: bool = True
    """Cut commands at omega_max. Only a kinematic vehicle can do without: it turns as fast as it is told."""
    preview: bool = True
    """Run the law ahead of time by the inner loop's measured lag."""
    airspeed_trim: bool = True
    """Trim the commanded airspeed by the along-track error."""
    airspeed_gain_per_s: Positive = 0.15
    """Commanded airspeed per along-track error [1/s]."""
    airspeed_trim_max_mps: Positive = 1.0
    """Largest change of commanded airspeed [m/s]."""
    keepout_guard: bool = True
    """Turn away from the keep-out area, of which the paper's law knows nothing."""
    rate_hz: Annotated[float, Field(ge=1.0, le=120.0)] = 20.0
    """Guidance rate [Hz]; must divide the 120 Hz of the simulation."""

    @model_validator(mode="after")
    def _bounded_law(self) -> "Guidance":
        if self.tuning == "bounded" and self.law != "cascade":
            raise ValueError(f"tuning is 'bounded' with law '{self.law}', which has no bound; set law to 'cascade'")
        return self

    @model_validator(mode="after")
    def _whole_steps(self) -> "Guidance":
        check_divides("rate_hz", self.rate_hz, 120.0)
        return self


class Start(Section):
    """Where flights begin: a seeded random place astern of the vessel, on any course, or a given one."""

    distance_m: tuple[Positive, Positive] = (400.0, 800.0)
    """Nearest and farthest distance from the vessel [m]."""
    spread_deg: Annotated[float, Field(ge=0.0, le=180.0)] = 30.0
    """Largest bearing from straight astern, either side [deg]."""
    course_deg: Annotated[float, Field(ge=-360.0, le=360.0)] | None = None
    """Initial course [deg]; any if not given."""
    place_m: tuple[float, float] | None = None
    """Place ahead and right of the vessel or, on a circle, of the reference's start; random if not given [m]."""

    @model_validator(mode="after")
    def _ordered(self) -> "Start":
        if self.distance_m[0] > self.distance_m[1]:
            raise ValueError(f"distance_m is {list(self.distance_m)}; its first value must not exceed its second")
        return self


class Flight(Section):
    """When a flight ends and what is recorded."""

    crossings: Annotated[int, Field(ge=2, le=10_000)] = 30
    """Crossings to fly after settling."""
    duration_max_s: Annotated[float, Field(gt=0.0, le=100_000.0)] = 1500.0
    """Longest flight [s]."""
    settling_band_m: Positive = 5.0
    """Settled from the moment the distance to the reference stays below this [m]."""
    log_rate_hz: Annotated[float, Field(ge=5.0, le=120.0)] = 10.0
    """Recording rate [Hz], at least 5 so that keep-out figures are true to centimetres; must divide the guidance rate."""


class Criteria(Section):
    """What a flight must show to count as met."""

    tracking_error_rms_m: Positive = 1.5
    """Largest rms distance to the reference after settling [m]."""
    airspeed_error_rms_mps: Positive = 0.3
    """Largest rms difference of airspeed from its command [m/s]."""
    altitude_error_max_m: Positive = 1.5
    """Largest difference of altitude from that of the CO [m]."""
    crossing_interval_error: Positive = 0.01
    """Largest relative difference of the mean crossing interval from pi/omega_0 [-]."""
    tracking_error_end_m: Positive | None = None
    """Largest distance to the reference at the end [m]."""
    crossing_interval_s: tuple[Positive, Positive] | None = None
    """Least and largest mean crossing interval [s]."""
    crossing_distance_m: tuple[Positive, Positive] | None = None
    """Least and largest mean crossing distance from the vessel [m]."""
    settles: bool = True
    """Whether the flight must settle; if not, tracking, airspeed and altitude are not judged."""
    law_beyond_heading_rate_max: bool = False
    """Whether the law must ask for more than omega_max, to show that it does; how commands are limited is then not judged."""
    law_within_heading_rate_max: bool = False
    """Whether the law itself must ask for no more than omega_max, before commands are cut."""


class Variant(Section):
    """A comparison: the same flights with some keys set otherwise."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9_]+$")]
    set: dict[str, object]


class Comparison(Section):
    """Extra flights that show what a part of the guidance is worth. They are reported apart and have no part in the verdict."""

    nu: tuple[Annotated[float, Field(ge=0.0, lt=1.0)], ...] = ()
    variants: tuple[Variant, ...] = ()


class Case(Section):
    """One flight of a study of cases, with some keys set otherwise; flown with each vehicle that ``fidelity`` names."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9_]+$")]
    set: dict[str, object] = {}
    set_kinematic: dict[str, object] = {}
    """More keys, for the kinematic vehicle alone."""
    comparison: bool = False
    """Reported apart, with no part in the verdict."""


class Scenario(Section):
    """A whole scenario file."""

    study: Literal["flights", "paper"] = "flights"
    """A flight for each of sweep.nu, or the cases that are the paper's simulations."""
    title: str
    description: str = ""
    aircraft: Annotated[str, Field(coerce_numbers_to_str=True)] = "x8"
    fidelity: Literal["six_dof", "kinematic", "both"] = "six_dof"
    """The aircraft in six degrees of freedom, the paper's kinematic vehicle, or (cases only) one after the other."""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = 1
    histories: Histories = 200
    sweep: Sweep = Sweep(nu=(0.5,))
    cases: tuple[Case, ...] = ()
    vessel: Vessel = Vessel()
    plume: Plume = Plume()
    keepout: Keepout = Keepout()
    kinematic: Kinematic = Kinematic()
    reference: Reference = Reference()
    guidance: Guidance = Guidance()
    start: Start = Start()
    flight: Flight = Flight()
    criteria: Criteria = Criteria()
    comparison: Comparison = Comparison()

    @model_validator(mode="after")
    def _rates(self) -> "Scenario":
        check_divides("flight.log_rate_hz", self.flight.log_rate_hz, self.guidance.rate_hz)
        return self

    @model_validator(mode="after")
    def _starts_outside(self) -> "Scenario":
        radius = self.keepout.radius_m
        # A distance that nobody gave is yet to be fitted to the aircraft, and checked then.
        to_be_fitted = self.start.place_m is None and "distance_m" not in self.start.model_fields_set and self.aircraft != "x8"
        if self.reference.path == "circle" or to_be_fitted:
            return self
        if self.start.place_m is None:
            nearest, where = self.start.distance_m[0], "start.distance_m begins at"
        else:
            nearest, where = math.hypot(*self.start.place_m), "start.place_m lies at"
        if nearest <= radius:
            raise ValueError(f"{where} {nearest:g} m; it must exceed keepout.radius_m, {radius:g} m")
        return self

    @model_validator(mode="after")
    def _study(self) -> "Scenario":
        if (self.study == "paper") != bool(self.cases):
            raise ValueError(f"study is '{self.study}' with {len(self.cases)} cases; 'paper' has cases, 'flights' has none")
        if len({case.name for case in self.cases}) < len(self.cases):
            raise ValueError(f"cases are named {', '.join(case.name for case in self.cases)}; give each a name of its own")
        if self.study == "flights" and "sweep" not in self.model_fields_set:
            raise ValueError("key 'sweep' is missing; add it to the scenario")
        if self.study == "flights" and self.fidelity == "both":
            raise ValueError("fidelity is 'both'; that is for studies of cases: give 'six_dof' or 'kinematic'")
        if self.study == "flights" and self.reference.path == "circle":
            raise ValueError("reference.path is 'circle'; that is for studies of cases, see scenarios/catalog/paper.toml")
        if self.fidelity == "six_dof" and not self.guidance.command_limit:
            raise ValueError(
                "guidance.command_limit is false; the aircraft cannot turn as fast as it is told: set fidelity=kinematic"
            )
        return self
