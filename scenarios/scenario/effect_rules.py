"""When keys of a scenario act: a rule for those that not every flight uses, with the part that
would use them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields

from measurement.plume.spread import PlumeSettings
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.experiment_checks import FOLLOWING, UNSTEADY
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.study_keys import StudyKeys

Test = Callable[[Scenario], bool]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """When some keys act.

    Attributes
    ----------
    keys : dotted keys, or the beginnings of keys that end in a dot
    acts : whether they do in a scenario
    user : the part that would use them, and how to have it
    depends : keys on which that depends: where they differ from flight to flight, the keys count as
        acting
    by_mission : whether that depends on the mission as well, and so on the keys from which it
        follows
    """

    keys: tuple[str, ...]
    acts: Test
    user: str
    depends: tuple[str, ...] = ()
    by_mission: bool = False


_TRACKS = "the mission that tracks the paper's reference; here the reference is steered: set guidance.mission to 'track'"
_FOLLOWS = (
    "the mission that follows the vessel with a steered reference: set guidance.mission to 'follow'"
)
_VESSEL = "an oscillation beside a vessel; here reference.path is 'circle'"
OPERATIONAL = (*UNSTEADY, "plume.direction")
"""Keys from which the mission follows where guidance.mission is not given."""


def _kinematic(scenario: Scenario) -> bool:
    return scenario.fidelity in ("kinematic", "both")


def _six_dof(scenario: Scenario) -> bool:
    return scenario.fidelity in ("six_dof", "both")


def _subset(scenario: Scenario) -> bool:
    return scenario.study == "monte_carlo" and scenario.method == "subset"


def _trims(scenario: Scenario) -> bool:
    return not scenario.follows and scenario.guidance.airspeed_trim


def _smoke(key: str) -> Test:
    """Return whether the project's smoke has a setting, or another plume model has whatever a key
    of that name means there.
    """
    return lambda s: bool(
        s.plume.model != "fluctuating"
        or (s.plume.model_extra or {}).get(key, getattr(PlumeSettings, key))
    )


def _law(*laws: str) -> Test:
    return lambda s: s.guidance.law in laws


def _rules_of(keys: type[StudyKeys]) -> Iterator[Rule]:
    """Yield the rules of the keys that a study adds, and of those that it does not use."""
    study = keys.STUDY
    yield Rule(
        keys=keys.prefixes(),
        acts=lambda s: s.study == study,
        user=f"{keys.USED_BY}: set study to '{study}'",
    )
    for key, instead in keys.UNUSED.items():
        yield Rule(keys=(key,), acts=lambda s: s.study != study, user=f"other studies; {instead}")


LAW_KEYS: tuple[tuple[str, str, Test], ...] = (
    ("lyapunov_gain_per_m2", "lyapunov", _law("lyapunov")),
    (
        "steering_max_rad_s",
        "cascade, where guidance.tuning is 'given'",
        lambda s: _law("cascade")(s) and s.guidance.tuning == "given",
    ),
    ("gain_per_s", "cascade or line_of_sight", _law("cascade", "line_of_sight")),
    (
        "epsilon_per_m",
        "cascade or lyapunov, where guidance.tuning is 'given'",
        lambda s: _law("cascade", "lyapunov")(s) and s.guidance.tuning == "given",
    ),
    (
        "look_ahead_m",
        "cascade or lyapunov, where guidance.tuning is 'given'",
        lambda s: s.follows or (_law("cascade", "lyapunov")(s) and s.guidance.tuning == "given"),
    ),
)
"""Keys of the project's own steering laws, the laws that use them, and whether one of them does.

A steered reference is kept pace with by the look-ahead, whatever the law
(``gnc.airspeed``).
"""


def _also_of_own_laws(key: str, used: Test) -> Test:
    """Return whether one of the project's laws uses a key, or one that is added has a field of its
    name.
    """
    return lambda s: (
        used(s)
        or (not _law("cascade", "lyapunov", "line_of_sight")(s) and key in s.guidance.law_keys)
    )


RULES = (
    Rule(keys=("guidance.phase_deg", "guidance.placement", "guidance.tracking_allowance_m"),
         acts=lambda s: not s.follows and not s.circles, user=_TRACKS, by_mission=True),
    Rule(keys=("guidance.tuning", "guidance.airspeed_trim", "guidance.command_limit"), acts=lambda s: not s.follows,
         user=_TRACKS, by_mission=True),
    Rule(
        keys=("guidance.phase_deg",),
        acts=lambda s: not s.guidance.approach or s.circles,
        user="a reference that is tracked from the first step on; an orbit that is joined has its own phase: set guidance.approach"
        " to false",
        depends=("guidance.approach",),
    ),
    Rule(
        keys=("guidance.airspeed_gain_per_s", "guidance.airspeed_trim_max_mps"),
        acts=_trims,
        user="trimming of the airspeed: set guidance.airspeed_trim to true, and guidance.mission to 'track'",
        by_mission=True,
        depends=("guidance.airspeed_trim",),
    ),
    Rule(
        keys=("guidance.bound_speed_margin_mps",),
        acts=lambda s: not s.follows and _six_dof(s) and s.guidance.law == "cascade",
        user="the bound on the cascade law's commands, for an aircraft that tracks the paper's reference",
        by_mission=True,
        depends=("guidance.law", "fidelity"),
    ),
    Rule(
        keys=("guidance.approach",),
        acts=lambda s: not s.follows and not s.circles,
        user="the mission that tracks the paper's reference; following has its own way to the vessel",
        by_mission=True,
    ),
    Rule(
        keys=(
            "guidance.keepout_guard", "guidance.reserve", "guidance.roll_rate_max_deg_s", "keepout.", "vessel.", "place.",
            "plume.model", "plume.direction", "plume.heading_deg", "plume.elevation_deg", "flight.crossings",
            "flight.after_settling_s", "reference.shape",
        ),
        acts=lambda s: not s.circles,
        user=_VESSEL,
    ),
    Rule(keys=("plume.elevation_deg",), acts=lambda s: s.plume.model != "fluctuating" or s.emission.ship is None,
         user="an axis without smoke; smoke rises by its own heat: leave it out", depends=("plume.model", "emission.ship")),
    Rule(keys=("reference.standoff_radius_m",), acts=lambda s: s.stands_off, user="a circle about the vessel: set guidance.mission"
         " to 'standoff'", by_mission=True),
    Rule(
        keys=("reference.shape", "guidance.reserve", "guidance.roll_rate_max_deg_s", "following.standoff_m",
              "following.join_distance_m", "following.distance", "following.source_height_m", "following.load"),
        acts=lambda s: not s.stands_off,
        user="an oscillation in the plume; here the vessel is circled: set guidance.mission to 'follow'",
        by_mission=True,
    ),
    Rule(keys=("following.margin_law",), acts=lambda s: s.follows and not s.turbulence.calm, user="a margin for turbulence: set"
         " turbulence.level", by_mission=True, depends=("turbulence.level", "turbulence.gusts")),
    Rule(keys=("guidance.bank_deg",), acts=lambda s: s.guidance.heading_rate_max_rad_s is None, user="omega_max, which"
         " guidance.heading_rate_max_rad_s gives directly: leave one of them out"),
    Rule(keys=("reference.radius_m",), acts=lambda s: s.circles, user="a circle: set reference.path to 'circle'",
         depends=("reference.path",)),
    Rule(keys=("guidance.preview",), acts=lambda s: _six_dof(s) or s.kinematic.heading_rate_lag_s > 0.0,
         user="a vehicle that lags behind its commands: set fidelity to 'six_dof', or kinematic.heading_rate_lag_s",
         depends=("kinematic.heading_rate_lag_s", "fidelity")),
    Rule(keys=("kinematic.",), acts=_kinematic, user="the kinematic vehicle: set fidelity to 'kinematic'",
         depends=("fidelity",)),
    Rule(keys=("turbulence.gust_length_s",), acts=lambda s: s.turbulence.gusts > 0, user="gusts: set turbulence.gusts",
         depends=("turbulence.gusts",)),
    Rule(keys=("emission.fuel", "emission.sulphur_percent", "emission.load", "wind.temperature_c", "wind.stability_per_s",
               "flight.altitude_min_m", "flight.altitude_max_m"),
         acts=lambda s: s.emission.ship is not None, user="a ship with exhaust: set emission.ship", depends=("emission.ship",)),
    Rule(keys=("following.plume", "following.distance", "following.source_height_m", "following.load"),
         acts=lambda s: s.emission.ship is not None, user="an oscillation in exhaust: set emission.ship",
         depends=("emission.ship",)),
    Rule(keys=("following.climb_gradient",), acts=lambda s: s.emission.ship is not None,
         user="a plume that rises: set emission.ship", depends=("emission.ship",)),
    Rule(keys=("following.search",), acts=lambda s: s.following.plume == "estimated",
         user="a plume that is searched for: set following.plume to 'estimated'", depends=("following.plume",)),
    Rule(keys=("flight.until",), acts=lambda s: "sniffer" in s.payload.instruments,
         user="a sniffer: put 'sniffer' into payload.instruments", depends=("payload.instruments",)),
    Rule(keys=("air.background_ppm", "air.background_s"), acts=lambda s: s.air.background != "none",
         user="a background that varies: set air.background", depends=("air.background",)),
    Rule(keys=("criteria.time_to_find_s", "criteria.within_altitudes", "air."), acts=lambda s: "sniffer" in s.payload.instruments,
         user="a sniffer: put 'sniffer' into payload.instruments", depends=("payload.instruments",)),
    Rule(keys=("flight.altitude_m",), acts=lambda s: s.follows and not s.stands_off,
         user="the mission that follows the vessel; the others fly at the height of the plume: set guidance.mission to 'follow'",
         by_mission=True),
    Rule(keys=("flight.measured_s",), acts=lambda s: bool(s.payload.instruments), user="instruments: set payload.instruments",
         depends=("payload.instruments",)),
    Rule(keys=("wind.speed_mps", "wind.from_deg"), acts=lambda s: s.wind.table is None,
         user="a wind that is not read from a table: leave out this key, or wind.table", depends=("wind.table",)),
    Rule(keys=("wind.from_deg",), acts=lambda s: s.wind.blows, user="wind: set wind.speed_mps",
         depends=("wind.speed_mps",)),
    Rule(keys=("wind.roughness_m", "wind.height_m"), acts=lambda s: s.wind.blows, user="wind: set wind.speed_mps or wind.table",
         depends=("wind.speed_mps", "wind.table")),
    Rule(keys=("wind.height_m",), acts=lambda s: s.wind.roughness_m is not None,
         user="a wind with a profile over height: set wind.roughness_m", depends=("wind.roughness_m",)),
    Rule(keys=tuple(f"plume.{of.name}" for of in fields(PlumeSettings)),
         acts=lambda s: s.plume.model != "fluctuating" or s.emission.ship is not None, user="smoke: set emission.ship",
         depends=("emission.ship",)),
    Rule(keys=("plume.meander", "plume.meander_length_across", "plume.meander_length_up", "plume.structure_intensity",
               "plume.structure_length"),
         acts=lambda s: s.plume.model != "fluctuating" or not _smoke("mean")(s),
         user="a realisation of smoke: leave plume.mean out", depends=("plume.mean",)),
    Rule(keys=("plume.meander_length_across", "plume.meander_length_up"), acts=_smoke("meander"),
         user="smoke that meanders: leave plume.meander out", depends=("plume.meander",)),
    Rule(keys=("plume.structure_length",), acts=_smoke("structure_intensity"),
         user="fluctuations within smoke: set plume.structure_intensity", depends=("plume.structure_intensity",)),
    Rule(keys=("plume.heading_deg",), acts=lambda s: not s.plume_by_wind,
         user="a plume at an angle from the bow: set plume.direction to 'given'", by_mission=True, depends=("plume.direction",)),
    Rule(keys=("following.apparent_wind_min_mps",), acts=lambda s: s.follows and s.plume_by_wind,
         user="a plume that trails with the apparent wind: set plume.direction to 'apparent_wind'",
         by_mission=True, depends=("plume.direction",)),
    Rule(keys=("following.join_distance_m", "following.tracked_m"),
         acts=lambda s: s.follows or (s.guidance.approach and not s.circles),
         user="the way to the orbit: set guidance.approach to true", by_mission=True, depends=("guidance.approach",)),
    Rule(
        keys=(
            "following.touches_per_hour", "following.margin_min_m", "following.speed_ratio_max", "following.standoff_m",
            "following.vessel_acceleration_mps2", "following.vessel_speed_max_mps", "following.speed_error_mps",
            "following.drift_rate_mps", "following.turn_deviation_m",
        ),
        acts=lambda s: s.follows,
        user=_FOLLOWS,
        by_mission=True,
    ),
    Rule(
        keys=("reports.position_sigma_m", "reports.velocity_sigma_mps", "reports.latency_max_s", "reports.missing"),
        acts=lambda s: not s.vessel_known,
        user="reports that come now and then: set reports.interval_s",
        depends=("reports.interval_s", "vessel.track"),
    ),
    Rule(keys=("vessel.mmsi", "vessel.gap_max_s"), acts=lambda s: s.vessel.from_file,
         user="a track from a file: set vessel.track to a file of AIS reports", depends=("vessel.track",)),
    Rule(keys=("vessel.speed_mps", "vessel.speed_ratio", "vessel.course_deg", "vessel.manoeuvres", "place.latitude_deg",
               "place.longitude_deg"),
         acts=lambda s: not s.vessel.from_file,
         user="a vessel whose track is not from a file, which says where it goes: leave out this key or vessel.track",
         depends=("vessel.track",)),
    Rule(keys=("fault.at_s",), acts=lambda s: s.fault.kind != "none", user="a fault: set fault.kind", depends=("fault.kind",)),
    Rule(keys=("fault.vessel_data_s",), acts=lambda s: s.fault.kind == "vessel_data",
         user="a loss of vessel data: set fault.kind to 'vessel_data'", depends=("fault.kind",)),
    Rule(keys=("fault.satellite_navigation_s",), acts=lambda s: s.fault.kind == "satellite_navigation",
         user="a loss of satellites: set fault.kind to 'satellite_navigation'", depends=("fault.kind",)),
    Rule(
        keys=("turbulence.", "wind.", "emission.", "reports.", "sensors.", "fault.", "vessel.manoeuvres", "vessel.track"),
        acts=lambda s: s.follows,
        user=FOLLOWING,
        by_mission=True,
    ),
    Rule(keys=("vessel.speed_mps",),
         acts=lambda s: s.vessel.speed_ratio is None and not {"nu", "vessel.speed_ratio"} & s.sweep.root.keys(),
         user="a vessel whose speed is not given by sweep.nu or vessel.speed_ratio: leave one of them out"),
    Rule(keys=("start.distance_m",), acts=lambda s: s.start.place_m is None and s.start.range_m is None,
         user="a random distance: leave out start.place_m and start.range_m", depends=("start.",)),
    Rule(keys=("start.spread_deg",), acts=lambda s: s.start.place_m is None and s.start.aspect_deg is None,
         user="a random bearing: leave out start.place_m and start.aspect_deg", depends=("start.",)),
    Rule(keys=("criteria.resumes_within_periods",), acts=lambda s: bool(s.vessel.manoeuvres) or s.vessel.track != "manoeuvres",
         user="a vessel that manoeuvres: set vessel.manoeuvres or vessel.track", depends=("vessel.manoeuvres", "vessel.track")),
    Rule(
        keys=("criteria.tracking_error_rms_m", "criteria.airspeed_error_rms_mps", "criteria.altitude_error_max_m"),
        acts=lambda s: s.criteria.settles,
        user="flights that must settle: set criteria.settles to true",
        depends=("criteria.settles",),
    ),
    Rule(keys=("criteria.crossing_interval_error", "criteria.crossing_interval_s", "criteria.crossing_distance_m",
               "criteria.modes_at_end"),
         acts=lambda s: not s.circles, user=_VESSEL),
    Rule(keys=("statistics.", "method"), acts=lambda s: s.study == "monte_carlo",
         user="a Monte Carlo study: set study to 'monte_carlo'"),
    Rule(keys=("sampling",), acts=lambda s: s.study == "monte_carlo" and s.method == "plain" and bool(s.draws),
         user="a Monte Carlo study with random variables and plain sampling: set study to 'monte_carlo' and method to 'plain', and"
         " give draws"),
    Rule(keys=("common_random_numbers",), acts=lambda s: bool(s.sweep.root), user="a sweep: give sweep several values of a key"),
    Rule(keys=("statistics.distance_quantile",), acts=lambda s: s.method == "plain",
         user="plain sampling, which may stop by it: set method to 'plain'"),
    Rule(keys=("subset.",), acts=_subset, user="subset simulation: set study to 'monte_carlo' and method to 'subset'"),
    Rule(keys=("flights",), acts=lambda s: not _subset(s), user="plain sampling; subset simulation flies subset.flights_per_level"
         " in each level of each of subset.repeats: set these, or set method to 'plain'"),
    Rule(keys=("search.",), acts=lambda s: s.study == "falsify", user="a search: set study to 'falsify'"),
    Rule(keys=("search.generations",), acts=lambda s: s.search.time_s is None,
         user="a search without a time: leave search.time_s out"),
    Rule(keys=("search.mutation", "search.recombination"), acts=lambda s: "differential_evolution" in s.search.methods,
         user="differential evolution: put 'differential_evolution' into search.methods"),
    Rule(keys=("search.restarts",), acts=lambda s: s.search.methods != ("corners",),
         user="methods that may become stuck: put 'local' or 'cma' into search.methods"),
    Rule(keys=("flights",), acts=lambda s: s.study != "falsify", user="other studies; a search flies search.population times one"
         " more than search.generations, at most, and then search.confirmations of each of search.kept flights: set these"),
    *(rule for added in ADDED for rule in _rules_of(added)),
    Rule(keys=("speed_ratio",), acts=lambda s: bool(s.draws), user="random variables: give draws"),
    Rule(keys=("comparison.nu",),
         acts=lambda s: not s.comparison.nu or (bool(s.comparison.variants) and {*s.comparison.nu} <= {*s.sweep.nu}),
         user="variants that are flown at swept speed ratios: give comparison.variants, and these ratios in sweep.nu, too, or use"
         " comparison.flights"),
    Rule(keys=("comparison.flights",), acts=lambda s: bool(s.comparison.variants), user="variants: give comparison.variants"),
    *(
        Rule(keys=(f"guidance.{key}",), acts=_also_of_own_laws(key, used), user=f"the steering law {laws}: set guidance.law",
             by_mission=True, depends=("guidance.law", "guidance.tuning"))
        for key, laws, used in LAW_KEYS
    ),
)  # fmt: skip
