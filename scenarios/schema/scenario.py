"""A scenario file: world, equipment, guidance, start, flight and criteria of its flights, and the experiment on them."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from gnc.laws.steering_law import ON_CIRCLE, ON_OSCILLATION
from measurement.emission.ship import funnel_height
from scenarios.schema.experiment_checks import check_together, unsteady_itself
from scenarios.schema.random_sample import is_random_sample
from scenarios.schema.sections.equipment import (
    REPORTS_MAX,
    FaultConfig,
    KinematicConfig,
    PayloadConfig,
    SensorsConfig,
    VesselReportsConfig,
)
from scenarios.schema.sections.experiment import (
    FLIGHTS_MAX,
    ArenaConfig,
    CaseConfig,
    ComparisonConfig,
    DrawConfig,
    Sampling,
    SearchConfig,
    StatisticsConfig,
    SubsetConfig,
    SweepConfig,
)
from scenarios.schema.sections.flight import CriteriaConfig, FlightConfig, StartConfig
from scenarios.schema.sections.guidance import FollowingConfig, GuidanceConfig, ReferenceConfig, law_refusal
from scenarios.schema.sections.patrol import PatrolConfig
from scenarios.schema.sections.report import ReportConfig
from scenarios.schema.sections.section import Range, Section, Seed, Title, check_divides, check_ordered
from scenarios.schema.sections.world import (
    EmissionConfig,
    KeepoutConfig,
    PlaceConfig,
    PlumeConfig,
    TurbulenceConfig,
    VesselConfig,
    WindConfig,
)

DEFAULT_AIRCRAFT = "x8"

POINTS_MAX = 10_000
"""Most points of an experiment: all are checked before the first flight, in a millisecond and 20 kB each."""


class Scenario(Section):
    """A whole scenario file of flights."""

    study: str = "flights"
    """flights; paper, with its bounds on commands; monte_carlo, with statistics; falsify, a search; arena, laws side by side;
    patrol, several ships one after the other; or FILE.py:NAME."""
    title: Title
    """What reports and lists call it."""
    description: str = ""
    """One or two sentences at the top of the report."""
    aircraft: Annotated[str, Field(coerce_numbers_to_str=True)] = DEFAULT_AIRCRAFT
    """The aircraft, by its name (plume-flight design --list), by the folder of its JSBSim model, DIR/NAME, or FILE.py:NAME."""
    fidelity: Literal["six_dof", "kinematic", "both"] = "six_dof"
    """Vehicle: the aircraft in six degrees of freedom, the paper's kinematic vehicle, or both."""
    seed: Seed = 1
    """Seed of the study, from which every flight's own seed follows [-]."""
    flights: Annotated[int, Field(ge=1, le=FLIGHTS_MAX)] = 1
    """Flights of each point of the experiment, each with a seed and a sample of the random variables of its own [-]."""
    flight_seed: Seed | None = None
    """Seed of start, air and noise of every flight; if not given, each flight has its own, from seed, name and number [-]."""
    histories: Annotated[int, Field(ge=0, le=100_000)] = 200
    """Number of time histories to be kept, evenly spaced over the flights [-]. Those of flights that did not meet what is required
    are kept as well; of missions that were not completed, that of the first of each trial."""
    speed_ratio: Range = (0.0, 1e9)
    """Flights whose nu leaves this range, at the start or after a manoeuvre, are sampled again [-]."""
    method: Literal["plain", "subset"] = "plain"
    """How a Monte Carlo study samples: plain, or by subset simulation, towards rare keep-out violations."""
    sampling: Sampling = "sobol"
    """How samples are spread: evenly over all random variables together (sobol), over each of them, or not at all."""
    sweep: SweepConfig = SweepConfig()
    cases: tuple[CaseConfig, ...] = ()
    draws: tuple[DrawConfig, ...] = ()
    comparison: ComparisonConfig = ComparisonConfig()
    statistics: StatisticsConfig = StatisticsConfig()
    subset: SubsetConfig = SubsetConfig()
    search: SearchConfig = SearchConfig()
    laws: tuple[str, ...] = ()
    """Laws that take part in an arena in addition to its own, each by its name or FILE.py:NAME."""
    arena: ArenaConfig = ArenaConfig()
    patrol: PatrolConfig = PatrolConfig()
    place: PlaceConfig = PlaceConfig()
    vessel: VesselConfig = VesselConfig()
    plume: PlumeConfig = PlumeConfig()
    keepout: KeepoutConfig = KeepoutConfig()
    wind: WindConfig = WindConfig()
    turbulence: TurbulenceConfig = TurbulenceConfig()
    reports: VesselReportsConfig = VesselReportsConfig()
    sensors: SensorsConfig = SensorsConfig()
    fault: FaultConfig = FaultConfig()
    emission: EmissionConfig = EmissionConfig()
    payload: PayloadConfig = PayloadConfig()
    kinematic: KinematicConfig = KinematicConfig()
    reference: ReferenceConfig = ReferenceConfig()
    guidance: GuidanceConfig = GuidanceConfig()
    following: FollowingConfig = FollowingConfig()
    start: StartConfig = StartConfig()
    flight: FlightConfig = FlightConfig()
    criteria: CriteriaConfig = CriteriaConfig()
    report: ReportConfig = ReportConfig()

    @property
    def circles(self) -> bool:
        """Return whether the reference circles, without a vessel."""
        return self.reference.path == "circle"

    @property
    def follows(self) -> bool:
        """Return whether the mission follows what it estimates: where that says so, or air or vessel are not steady and known."""
        if self.guidance.mission is not None:
            return self.guidance.mission != "track"
        return bool(unsteady_itself(self)) or self.plume.model != "straight" or self.plume.direction == "apparent_wind"

    @property
    def vessel_known(self) -> bool:
        """Return whether the vessel's motion is known at all times, and not from reports."""
        return self.reports.exact and not self.vessel.from_file

    @property
    def stands_off(self) -> bool:
        """Return whether the vessel is circled, without an oscillation."""
        return self.guidance.mission == "standoff"

    @property
    def finds(self) -> bool:
        """Return whether a plume is searched for, given, or measured until there is a verdict."""
        return self.following.plume != "predicted" or self.flight.until == "verdict"

    @property
    def source_height(self) -> float:
        """Return the height of the funnel's mouth above the sea: as it is given, else that of the ship [m]."""
        return funnel_height(self.plume.source_height_m, self.emission.ship)

    @property
    def altitude(self) -> float:
        """Return the altitude at the start, for which the autopilot is designed [m]."""
        flight, height = self.flight, self.source_height
        if flight.altitude_m is not None:
            return flight.altitude_m
        return height if self.emission.ship is None else flight.altitude_beside(height, self.turbulence.level)

    @property
    def declared_faults(self) -> frozenset[str]:
        """Return the kinds of faults that its flights may have, and those that they declare beside."""
        drawn = [value for draw in self.draws if draw.key == "fault.kind" for value in draw.choice or ()]
        varied = [*map(str, drawn), *map(str, self.sweep.root.get("fault.kind", ()))]
        return frozenset({self.fault.kind, *self.fault.declared, *varied} - {"none"})

    @property
    def plume_by_wind(self) -> bool:
        """Return whether the plume trails behind the vessel's motion through the air."""
        return self.plume.direction == "apparent_wind" or (self.plume.direction is None and self.follows)

    @property
    def vessel_speed(self) -> float:
        """Return the vessel's speed over the ground before any manoeuvre [m/s]."""
        ratio = self.vessel.speed_ratio
        return self.vessel.speed_mps if ratio is None else ratio * self.guidance.airspeed_mps

    @property
    def nu_over_ground(self) -> float:
        """Return the vessel's speed over the ground over V_r, which is nu in still air [-]."""
        ratio = self.vessel.speed_ratio
        return self.vessel.speed_mps / self.guidance.airspeed_mps if ratio is None else ratio

    @property
    def several_points(self) -> bool:
        """Return whether its experiment has points that differ otherwise than at random: by a sweep, cases, a comparison or two
        vehicles."""
        return bool(self.sweep.root or self.cases or self.comparison.variants) or self.fidelity == "both"

    @property
    def sampled_at_random(self) -> bool:
        """Return whether its flights are a random sample, from which a bound on a probability follows."""
        return is_random_sample(self)

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        check_divides("flight.log_rate_hz", self.flight.log_rate_hz, self.guidance.rate_hz)
        check_ordered("speed_ratio", self.speed_ratio)
        if self.circles and (self.follows or self.sweep.root or self.draws):
            raise ValueError(
                "reference.path is 'circle' beside wind, a vessel that is followed, a sweep or draws; a circle has no vessel:"
                " set reference.path to 'oscillation', or put it into a case of its own"
            )
        if self.circles and self.criteria.required == "keep_out":
            raise ValueError("criteria.required is 'keep_out', and a circle has no area to keep out of; set it to 'criteria'")
        if self.fidelity == "six_dof" and not self.guidance.command_limit:
            raise ValueError("guidance.command_limit is false; an aircraft cannot turn so fast: set fidelity to 'kinematic'")
        if not (self.guidance.command_limit or self.follows or self.circles) and self.guidance.approach:
            raise ValueError(
                "guidance.command_limit is false and guidance.approach true; the way to the orbit has turns at the limit:"
                " set guidance.approach to false"
            )
        if not self.guidance.command_limit and self.guidance.keepout_guard and self.kinematic.heading_rate_lag_s > 0.0:
            raise ValueError(
                "guidance.command_limit is false with kinematic.heading_rate_lag_s; the keep-out guard predicts one with a lag"
                " within the limit alone: leave one of them out, or set guidance.keepout_guard to false"
            )
        if self.fidelity == "kinematic" and not self.turbulence.calm:
            raise ValueError(
                "turbulence.level or turbulence.gusts is set with fidelity 'kinematic', which feels the steady wind alone:"
                " set fidelity to 'six_dof', or turbulence.level to 'none' and turbulence.gusts to 0"
            )
        return self

    @model_validator(mode="after")
    def _law_has_the_task(self) -> "Scenario":
        law = self.guidance.law
        if not self.circles and (reason := law_refusal(law, ON_CIRCLE if self.stands_off else ON_OSCILLATION)):
            raise ValueError(f"guidance.law is '{law}': {reason}")
        return self

    @model_validator(mode="after")
    def _starts_outside(self) -> "Scenario":
        radius, start = self.keepout.radius_m, self.start
        # A default distance is scaled to the aircraft later, and checked then.
        to_be_scaled = start.range_m is None and "distance_m" not in start.model_fields_set and self.aircraft != DEFAULT_AIRCRAFT
        if self.circles:
            return self
        if start.place_m is not None:
            nearest, where = math.hypot(*start.place_m), "start.place_m lies at"
        elif start.range_m is not None:
            nearest, where = start.range_m, "start.range_m is"
        elif to_be_scaled or any(draw.key == "start.range_m" for draw in self.draws):
            # Each flight's own distance is checked once it is sampled.
            return self
        else:
            nearest, where = start.distance_m[0], "start.distance_m begins at"
        if nearest <= radius:
            raise ValueError(f"{where} {nearest:g} m; it must exceed keepout.radius_m, {radius:g} m")
        return self

    @model_validator(mode="after")
    def _fits_into_the_flight(self) -> "Scenario":
        air, room = self.turbulence, self.flight.duration_max_s
        if self.fault.kind != "none" and self.fault.at_s[1] >= room:
            raise ValueError(
                f"fault.at_s ends at {self.fault.at_s[1]:g} s; it must lie within flight.duration_max_s, {room:g} s:"
                " fly longer, or let it fail earlier"
            )
        if air.gusts * 2.0 * air.gust_length_s > 0.9 * room:
            raise ValueError(
                f"turbulence.gusts is {air.gusts}, each {2.0 * air.gust_length_s:g} s long; they do not fit into"
                f" flight.duration_max_s, {room:g} s: give fewer or shorter ones"
            )
        interval = 0.5 * sum(self.reports.interval_s)
        if not self.reports.exact and room > REPORTS_MAX * interval:
            raise ValueError(
                f"reports.interval_s is {list(self.reports.interval_s)} s; in flight.duration_max_s, {room:g} s, this makes"
                f" more than {REPORTS_MAX} reports: let at least {room / REPORTS_MAX:.2g} s pass between them on average, or fly"
                " shorter"
            )
        return self

    @model_validator(mode="after")
    def _track_has_its_own_speed(self) -> "Scenario":
        given = [key for key in ("nu", "vessel.speed_ratio", "vessel.speed_mps") if key in self.sweep.root]
        if self.vessel.from_file and given:
            raise ValueError(
                f"sweep has {given[0]} beside vessel.track, a file that the vessel's speed comes from; leave one of them out"
            )
        return self

    @model_validator(mode="after")
    def _experiment(self) -> "Scenario":
        names = [case.name for case in self.cases]
        if len(set(names)) < len(names):
            raise ValueError(f"cases are named {', '.join(names)}; give each a name of its own")
        if self.cases and self.sweep.root:
            raise ValueError(f"sweep has {', '.join(self.sweep.root)} beside {len(names)} cases; give one of the two")
        if (points := math.prod(map(len, self.sweep.root.values()))) > POINTS_MAX:
            raise ValueError(f"sweep has {points} points; the most is {POINTS_MAX}: give fewer values, or sample keys at random")
        if self.study == "paper" and not self.cases:
            raise ValueError("study is 'paper' without cases; give it cases, or set study to 'flights'")
        return self

    @model_validator(mode="after")
    def _together(self) -> "Scenario":
        check_together(self)
        return self
