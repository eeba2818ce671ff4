"""A scenario file: world, equipment, guidance, start, flight and criteria of its flights, and the
experiment on them.
"""

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, model_validator

from common.faults import NO_FAULT
from measurement.emission import stack_height_of
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.consistency import check_consistency
from scenarios.scenario.sections.equipment import (
    FaultConfig,
    KinematicConfig,
    OneOrSeveralFaults,
    PayloadConfig,
    SensorsConfig,
    VesselReportsConfig,
)
from scenarios.scenario.sections.experiment import (
    FLIGHTS_MAX,
    CaseConfig,
    ComparisonConfig,
    DrawConfig,
    Sampling,
    SearchConfig,
    StatisticsConfig,
    SubsetConfig,
    SweepConfig,
)
from scenarios.scenario.sections.flight import CriteriaConfig, FlightConfig, StartConfig
from scenarios.scenario.sections.guidance import FollowingConfig, GuidanceConfig, ReferenceConfig
from scenarios.scenario.sections.needs import Need, when
from scenarios.scenario.sections.report import ReportConfig
from scenarios.scenario.sections.section import Range, Section, Seed, Title
from scenarios.scenario.sections.traffic import TRAFFIC_MAX, TrafficConfig
from scenarios.scenario.sections.world import (
    AirConfig,
    EmissionConfig,
    KeepoutConfig,
    PlaceConfig,
    PlumeConfig,
    TableConfig,
    TurbulenceConfig,
    VesselConfig,
    WindConfig,
)

DEFAULT_AIRCRAFT = "x8"


if TYPE_CHECKING:
    _AddedKeys = Section
else:
    _AddedKeys = type("_AddedKeys", (*ADDED, Section), {"__module__": __name__})
    """The keys that studies of installed packages add."""


class Scenario(_AddedKeys):
    """A whole scenario file of flights, and what follows from its keys."""

    study: str = "flights"
    """flights; paper, with its bounds on commands; monte_carlo, with statistics; falsify, a search;
    arena, laws side by side; patrol, several ships one after the other; or FILE.py:NAME."""
    title: Title
    """What reports and lists call it."""
    description: str = ""
    """One or two sentences at the top of the report."""
    aircraft: Annotated[str, Field(coerce_numbers_to_str=True)] = DEFAULT_AIRCRAFT
    """The aircraft, by its name (plume-flight design --list), by the folder of its JSBSim model,
    DIR/NAME, or FILE.py:NAME.
    """
    fidelity: Literal["six_dof", "kinematic", "both"] = "six_dof"
    """Vehicle: the aircraft in six degrees of freedom, the paper's kinematic vehicle, or both."""
    seed: Seed = 1
    """Seed of the study, from which every flight's own seed follows [-]."""
    flights: Annotated[
        int,
        Field(ge=1, le=FLIGHTS_MAX),
        Need(
            lambda s: s.study != "monte_carlo" or s.method != "subset",
            "plain sampling; subset simulation flies subset.flights_per_level in each level of each"
            " of subset.repeats: set these, or set method to 'plain'",
        ),
        Need(
            lambda s: s.study != "falsify",
            "other studies; a search flies search.population times one more than"
            " search.generations, at most, and then search.confirmations of each of search.kept"
            " flights: set these",
        ),
    ] = 1
    """Flights of each point of the experiment, each with a seed and a sample of the random
    variables of its own [-].
    """
    flight_seed: Seed | None = None
    """Seed of start, air and noise of every flight; if not given, each flight has its own, from
    seed, name and number [-].
    """
    histories: Annotated[
        int,
        Field(ge=0, le=100_000),
    ] = 200
    """Number of time histories to be kept, evenly spaced over the flights [-]. Those of flights
    that did not meet what is required are kept as well; of missions that were not completed, that
    of the first of each trial."""
    speed_ratio: Annotated[Range, when("draws", user="random variables")] = (
        0.0,
        1e9,
    )
    """Flights whose nu leaves this range, at the start or after a manoeuvre, are sampled again [-].
    """
    method: Annotated[
        Literal["plain", "subset"], when("study", "monte_carlo", user="a Monte Carlo study")
    ] = "plain"
    """How a Monte Carlo study samples: plain, or by subset simulation, towards rare keep-out
    violations.
    """
    sampling: Annotated[
        Sampling,
        Need(
            lambda s: s.study == "monte_carlo" and s.method == "plain" and s.draws,
            "a Monte Carlo study with random variables and plain sampling: set study to"
            " 'monte_carlo' and method to 'plain', and give draws",
        ),
    ] = "sobol"
    """How samples are spread: evenly over all random variables together (sobol), over each of them
    (latin_hypercube), or not at all (random)."""
    sweep: SweepConfig = SweepConfig()
    common_random_numbers: Annotated[
        bool | None,
        Need(lambda s: s.sweep.root, "a sweep: give sweep several values of a key"),
    ] = None
    """Whether the points of a sweep have the same starts, noise, sampled instruments and random
    variables, so that they differ in what is swept alone; if false, each point has its own. If not
    given: false with instruments on board, else true, but for speed ratios of one flight each.
    """
    cases: tuple[CaseConfig, ...] = ()
    draws: tuple[DrawConfig, ...] = ()
    comparison: ComparisonConfig = ComparisonConfig()
    statistics: StatisticsConfig = StatisticsConfig()
    subset: SubsetConfig = SubsetConfig()
    search: SearchConfig = SearchConfig()
    place: PlaceConfig = PlaceConfig()
    vessel: VesselConfig = VesselConfig()
    plume: PlumeConfig = PlumeConfig()
    keepout: KeepoutConfig = KeepoutConfig()
    traffic: Annotated[tuple[TrafficConfig, ...], Field(max_length=TRAFFIC_MAX)] = ()
    wind: WindConfig = WindConfig()
    table: TableConfig = TableConfig()
    turbulence: TurbulenceConfig = TurbulenceConfig()
    air: AirConfig = AirConfig()
    reports: VesselReportsConfig = VesselReportsConfig()
    sensors: SensorsConfig = SensorsConfig()
    fault: OneOrSeveralFaults = FaultConfig()
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

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        check_consistency(self)
        return self

    @property
    def own_random_numbers(self) -> bool:
        """Return whether each point of a sweep has random numbers of its own. With common numbers,
        the errors of one sampled instrument would be the same at all points.
        """
        if self.common_random_numbers is not None:
            return not self.common_random_numbers
        return bool(self.payload.instruments) or "payload.instruments" in self.sweep.root

    @property
    def circles(self) -> bool:
        """Return whether the reference circles, without a vessel."""
        return self.reference.path == "circle"

    @property
    def follows(self) -> bool:
        """Return whether the mission follows estimates of vessel and wind. If the mission is not
        given, it does so unless air and vessel are steady and known.
        """
        if self.guidance.mission is not None:
            return self.guidance.mission != "track"
        return (
            bool(self.unsteady_keys)
            or self.plume.model != "straight"
            or self.plume.direction == "apparent_wind"
        )

    @property
    def unsteady_keys(self) -> tuple[str, ...]:
        """Return the keys that make air or vessel unsteady or not exactly known; sweep and draws
        are not considered.
        """
        air, sensors = self.turbulence, self.sensors.model_dump()
        given = {
            "wind.table": self.wind.table is not None,
            "wind.speed_mps": self.wind.speed_mps > 0.0,
            "turbulence.level": air.level != "none",
            "turbulence.gusts": air.gusts > 0,
            "emission.ship": self.emission.ship is not None,
            "vessel.manoeuvres": bool(self.vessel.manoeuvres),
            "vessel.track": self.vessel.track != "manoeuvres",
            "traffic": bool(self.traffic),
            "reports.interval_s": not self.reports.exact,
            **{f"sensors.{name}": error > 0.0 for name, error in sensors.items()},
            "fault.kind": any(fault.kind != NO_FAULT for fault in self.faults),
        }
        return tuple(key for key, has in given.items() if has)

    @property
    def vessel_known(self) -> bool:
        """Return whether the vessel's motion is known at all times, and not from reports."""
        return self.reports.exact and not self.vessel.from_file

    @property
    def has_traffic(self) -> bool:
        """Return whether there may be ships besides the one that is measured."""
        studied = any(self.study == keys.STUDY and keys.TRAFFIC for keys in ADDED)
        return bool(self.traffic) or self.vessel.from_file or studied

    @property
    def stands_off(self) -> bool:
        """Return whether the vessel is circled, without an oscillation."""
        return self.guidance.mission == "standoff"

    @property
    def finds(self) -> bool:
        """Return whether the flight searches for the plume, is given its axis, or measures until
        there is a verdict.
        """
        return self.following.plume != "predicted" or self.flight.until == "verdict"

    @property
    def guarded_radius(self) -> float:
        """Return the distance to keep from the funnel [m], sufficient at every heading of the ship:
        r_min, plus the distance of the hull's farthest point if r_min is measured from the hull.
        """
        hull = self.vessel.hull
        reach = hull.farthest if hull is not None and self.keepout.from_hull else 0.0
        return self.keepout.radius_m + reach

    @property
    def guarded_keepout(self) -> KeepoutConfig:
        """Return the keep-out area about the funnel that has ``guarded_radius``."""
        return self.keepout.model_copy(update={"radius_m": self.guarded_radius})

    @property
    def source_height(self) -> float:
        """Return the height of the funnel's mouth above the sea [m]: the given one, or else that of
        the ship.
        """
        return stack_height_of(self.plume.source_height_m, self.emission.ship)

    @property
    def altitude(self) -> float:
        """Return the altitude at the start, for which the autopilot is designed [m]."""
        flight, height = self.flight, self.source_height
        if flight.altitude_m is not None:
            return flight.altitude_m
        return (
            height
            if self.emission.ship is None
            else flight.altitude_beside(height, self.turbulence.level)
        )

    @property
    def declared_faults(self) -> frozenset[str]:
        """Return the kinds of faults that its flights may have, and those that they declare."""
        declared = {kind for fault in self.faults for kind in fault.declared}
        flown = {kind for i in range(len(self.faults)) for kind in self.kinds_of_fault(i)}
        return frozenset((declared | flown) - {NO_FAULT})

    @property
    def faults(self) -> tuple[FaultConfig, ...]:
        """Return its faults. There is at least one, which may be of the kind ``none``."""
        given = self.fault if isinstance(self.fault, tuple) else (self.fault,)
        return given or (FaultConfig(),)

    def fault_key(self, number: int, name: str) -> str:
        """Return the dotted key of a fault, by its number from 0."""
        return f"fault.{number}.{name}" if isinstance(self.fault, tuple) else f"fault.{name}"

    def kinds_of_fault(self, number: int) -> frozenset[str]:
        """Return the kinds of a fault, by its number from 0: the given one, and those that are
        swept or sampled.
        """
        key = self.fault_key(number, "kind")
        drawn = [value for draw in self.draws if draw.key == key for value in draw.choice or ()]
        varied = [*map(str, drawn), *map(str, self.sweep.root.get(key, ()))]
        return frozenset({self.faults[number].kind, *varied})

    @property
    def plume_by_wind(self) -> bool:
        """Return whether the plume trails behind the vessel's motion through the air."""
        return self.plume.direction == "apparent_wind" or (
            self.plume.direction is None and self.follows
        )

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
        """Return whether its experiment has points that differ by a sweep, cases, a comparison or
        two vehicles, and not only at random.
        """
        return (
            bool(self.sweep.root or self.cases or self.comparison.variants)
            or self.fidelity == "both"
        )
