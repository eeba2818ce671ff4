"""The sections of a scenario file on the guidance: the reference, the steering law, and how to
follow a vessel that is not known exactly.
"""

import sys
from collections.abc import Mapping
from dataclasses import MISSING, fields
from dataclasses import Field as DataclassField
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from common.errors import PluginError
from common.text import did_you_mean, nearest
from gnc.laws import ON_CIRCLE, ON_OSCILLATION, STEERING_LAWS
from scenarios.scenario.sections.needs import (
    EXHAUST,
    FOLLOWS,
    OSCILLATES,
    TRACKS,
    VESSEL,
    Need,
    when,
)
from scenarios.scenario.sections.section import (
    Angle,
    NonNegative,
    Positive,
    Section,
    check_divides,
    check_ordered,
)

Share = Annotated[float, Field(gt=0.0, le=1.0)]


def known_law(law: str) -> str:
    """Return the name of a steering law, or raise a ValueError if there is no such law, or if a
    parameter of it has no default.
    """
    try:
        _law_keys(law)
    except PluginError as error:
        raise ValueError(str(error)) from None
    return law


class ReferenceConfig(Section):
    """The path of the reference point."""

    path: Literal["oscillation", "circle"] = "oscillation"
    """Oscillate about a centre in the plume, eq. (2), or circle without a vessel, as in the paper's
    Sims. 1 and 2.
    """
    shape: Annotated[str, VESSEL, OSCILLATES] = "sinusoid"
    """Shape of the oscillation: sinusoid, that of the paper, fastest, loiter, or FILE.py:NAME."""
    radius_m: Annotated[Positive, when("reference.path", "circle", user="a circle")] = 130.0
    """Radius of the circle, flown to the right [m]."""
    standoff_radius_m: Annotated[
        Positive | None,
        when("guidance.mission", "standoff", user="a circle about the vessel"),
    ] = None
    """Radius of a standoff circle about the vessel [m]; if not given, the smallest on which the
    keep-out guard need not act.
    """


LAW_KEYS = (
    "lyapunov_gain_per_m2",
    "steering_max_rad_s",
    "gain_per_s",
    "epsilon_per_m",
    "look_ahead_m",
)
"""Keys of the project's own steering laws."""

_OWN_LAWS = ("cascade", "lyapunov", "line_of_sight")


def _by_law(key: str, *laws: str, if_given: bool = False, paces: bool = False) -> Need:
    """Return the need of a key that some of the project's laws use, or one that is added and has a
    field of its name.

    Parameters
    ----------
    key : of the section
    laws : that use it
    if_given : whether they use it only with guidance.tuning 'given'
    paces : whether the key also sets how the airspeed keeps pace with a steered reference, with any
        law (``gnc.airspeed``)
    """

    def acts(s: Any) -> object:
        if paces and s.follows:
            return True
        if s.guidance.law in _OWN_LAWS:
            return s.guidance.law in laws and not (if_given and s.guidance.tuning != "given")
        return key in s.guidance.law_keys

    given = ", where guidance.tuning is 'given'" if if_given else ""
    return Need(acts, f"the steering law {' or '.join(laws)}{given}: set guidance.law")


_TRIMS = Need(
    lambda s: not s.follows and s.guidance.airspeed_trim,
    "trimming of the airspeed: set guidance.airspeed_trim to true, and guidance.mission to 'track'",
)
_WAY = Need(
    lambda s: s.follows or (s.guidance.approach and not s.circles),
    "the way to the orbit: set guidance.approach to true",
)


class GuidanceConfig(Section):
    """The paper's outer loop. A steering law may add keys: the fields of its dataclass."""

    model_config = ConfigDict(extra="allow")

    mission: Literal["track", "follow", "standoff"] | None = None
    """Mission: track the paper's reference, known in advance; follow the vessel with a steered
    reference, an oscillation in its plume; standoff, circle it at reference.standoff_radius_m, and
    cross its plume once a turn, without following.standoff_m.

    If not given: track in still air where the vessel is steady and known exactly, else follow.
    """
    law: str = "cascade"
    """Steering law: cascade, eq. (30), lyapunov, eq. (24), line_of_sight, the baseline, those of
    extensions/arena/page.md, or FILE.py:NAME."""
    airspeed_mps: Annotated[float, Field(ge=5.0, le=300.0)] = 19.42
    """V_r, speed of the reference and of the UAV [m/s]; the aircraft's own if not given."""
    bank_deg: Annotated[
        float,
        Field(gt=0.0, le=60.0),
        Need(
            lambda s: s.guidance.heading_rate_max_rad_s is None,
            "omega_max, which guidance.heading_rate_max_rad_s gives directly: leave one out",
        ),
    ] = 45.0
    """Bank whose coordinated turn sets omega_max = g tan(bank)/V_r [deg]; the aircraft's own if not
    given.
    """
    heading_rate_max_rad_s: Positive | None = None
    """omega_max [rad/s]; overrides bank_deg."""
    reserve: Annotated[float, Field(ge=0.0, lt=1.0), VESSEL, OSCILLATES] = 0.015
    """Fraction of omega_max that the reference leaves to feedback [-]; 0 in the paper."""
    roll_rate_max_deg_s: Annotated[float, Field(gt=0.0, le=360.0), VESSEL, OSCILLATES] = 40.0
    """Largest roll rate of the reference [deg/s]."""
    phase_deg: Annotated[
        Angle,
        TRACKS,
        VESSEL,
        Need(
            lambda s: not s.guidance.approach,
            "a reference that is tracked from the first step on; an orbit that is joined has its"
            " own phase: set guidance.approach to false",
        ),
    ] = 0.0
    """Oscillation phase phi_0 [deg]."""
    placement: Annotated[Literal["paper", "exact"], TRACKS, VESSEL] = "paper"
    """Rule for r_CO: paper, eq. (10), where eq. (11) holds for the orbit, which it does not for a
    loiter; or exact, the smallest for which the whole orbit stays outside. Farther where the guard
    would act on it.
    """
    tracking_allowance_m: Annotated[float, Field(ge=0.0, le=10_000.0), TRACKS, VESSEL] = 1.0
    """Allowance for tracking errors, added to r_min in the placement [m]."""
    tuning: Annotated[Literal["given", "bounded"], TRACKS] = "given"
    """Look-ahead and steering_max: given, or bounded, those that converge fastest while no state
    demands more than omega_max.
    """
    bound_speed_margin_mps: Annotated[
        NonNegative,
        Need(
            lambda s: not s.follows and s.fidelity != "kinematic" and s.guidance.law == "cascade",
            "the bound on the cascade law's commands, for an aircraft that tracks the paper's"
            " reference",
        ),
    ] = 0.5
    """Largest excess of the aircraft's speed over the largest commanded airspeed for which the
    bound on commands holds [m/s].
    """
    epsilon_per_m: Annotated[
        Positive, _by_law("epsilon_per_m", "cascade", "lyapunov", if_given=True)
    ] = 0.005
    """epsilon of the look-ahead, eq. (15) [1/m]."""
    look_ahead_m: Annotated[
        Positive, _by_law("look_ahead_m", "cascade", "lyapunov", if_given=True, paces=True)
    ] = 60.0
    """R of the look-ahead, eq. (15) [m]; above 1/(4 epsilon)."""
    gain_per_s: Annotated[Positive, _by_law("gain_per_s", "cascade", "line_of_sight")] = 1.5
    """Slope of h(phi) in eq. (30), and gain of the line-of-sight law [1/s]."""
    steering_max_rad_s: Annotated[
        Positive, _by_law("steering_max_rad_s", "cascade", if_given=True)
    ] = 0.4
    """Largest |h(phi)| in eq. (30) [rad/s]."""
    lyapunov_gain_per_m2: Annotated[Positive, _by_law("lyapunov_gain_per_m2", "lyapunov")] = 0.001
    """k_1 of eq. (24) [1/m2]."""
    command_limit: Annotated[bool, TRACKS] = True
    """Limit commands to omega_max. Only a kinematic vehicle can do without: it turns as fast as it
    is commanded.
    """
    preview: Annotated[
        bool,
        Need(
            lambda s: s.fidelity != "kinematic" or s.kinematic.heading_rate_lag_s > 0.0,
            "a vehicle that lags behind its commands: set fidelity to 'six_dof', or"
            " kinematic.heading_rate_lag_s",
        ),
    ] = True
    """Evaluate the law ahead of time, by the inner loop's measured lag."""
    airspeed_trim: Annotated[bool, TRACKS] = True
    """Correct the commanded airspeed by the along-track error."""
    airspeed_gain_per_s: Annotated[Positive, _TRIMS] = 0.15
    """Commanded airspeed per along-track error [1/s]."""
    airspeed_trim_max_mps: Annotated[Positive, _TRIMS] = 1.0
    """Largest change of commanded airspeed [m/s]."""
    keepout_guard: Annotated[bool, VESSEL] = True
    """Guard the keep-out area: turn away from it, which the paper's law does not."""
    approach: Annotated[bool, TRACKS, VESSEL] = True
    """Fly round the vessel to the orbit and join it at the phase that takes the least effort; the
    paper tracks its reference from the first step on."""
    rate_hz: Annotated[float, Field(ge=5.0, le=120.0)] = 20.0
    """Guidance rate [Hz]; must divide the 120 Hz of the simulation."""

    @field_validator("law")
    @classmethod
    def _known(cls, law: str) -> str:
        return known_law(law)

    @model_validator(mode="after")
    def _law(self) -> "GuidanceConfig":
        if self.tuning == "bounded" and self.law != "cascade":
            raise ValueError(
                f"tuning is 'bounded' with law '{self.law}', which has no bound; set law to"
                " 'cascade'"
            )
        check_divides("rate_hz", self.rate_hz, 120.0)
        keys, types = self.law_keys, self.law_types if self.model_extra else {}
        for name, value in (self.model_extra or {}).items():
            if name not in keys:
                meant = nearest(name, [*type(self).model_fields, *keys])
                guess = f"; did you mean 'guidance.{meant}'?" if meant else ""
                others = f"; those of law '{self.law}' are {', '.join(keys)}"
                raise ValueError(f"unknown key 'guidance.{name}'{guess or others}")
            if (expected := _expected(types[name], value)) is not None:
                raise ValueError(
                    f"{name} is {value!r}; law '{self.law}' takes {expected}, by default"
                    f" {keys[name]!r}"
                )
        return self

    @property
    def law_keys(self) -> dict[str, Any]:
        """Return the keys of the steering law, and their defaults.

        Raises
        ------
        PluginError : there is no such law, or it does not load
        """
        return _law_keys(self.law)

    @property
    def law_types(self) -> dict[str, type[Any] | None]:
        """Return the types of the keys of the steering law: bool, int, float, str, or None for
        others; errors as ``law_keys``.
        """
        keys, law = self.law_keys, STEERING_LAWS.get(self.law)
        return {of.name: _type_of(of.type, keys[of.name]) for of in _fields_of(law)}

    def keys_lost_with(self, law: object) -> list[str]:
        """Return the keys given here that are those of this steering law and not of ``law``."""
        given = self.model_extra or {}
        if not (given and isinstance(law, str)):
            return []
        try:
            return [name for name in given if name not in _law_keys(law)]
        except PluginError:
            return []


def law_refusal(law: str, task: str) -> str:
    """Return why a steering law cannot do a task, ``gnc.laws.ON_OSCILLATION`` or ``ON_CIRCLE``; an
    empty text if it can.
    """
    return _reasons(law).get(task, "")


def _reasons(law: str) -> Mapping[str, str]:
    """Return the reasons why a steering law cannot do some tasks, by the task."""
    reasons: Any = getattr(STEERING_LAWS.get(law), "unsupported_tasks", {})
    tasks = (ON_OSCILLATION, ON_CIRCLE)
    if not isinstance(reasons, Mapping):
        raise PluginError(
            f"steering law '{law}' has unsupported_tasks = {reasons!r}; give the reason by the"
            f" task, as in unsupported_tasks = {{'{ON_CIRCLE}': 'it ...'}}"
        )
    for task, reason in reasons.items():
        if task not in tasks:
            raise PluginError(
                f"steering law '{law}' has the task {task!r} in unsupported_tasks"
                f"{did_you_mean(str(task), tasks) or ';'} tasks are {' and '.join(tasks)}"
            )
        if not isinstance(reason, str):
            raise PluginError(
                f"steering law '{law}' has unsupported_tasks['{task}'] = {reason!r};"
                " give the reason in words"
            )
    found: Mapping[str, str] = reasons
    return found


def _law_keys(law: str) -> dict[str, Any]:
    _reasons(law)
    try:
        of_dataclass = _fields_of(STEERING_LAWS.get(law))
    except TypeError:
        raise PluginError(
            f"steering law '{law}' is not a dataclass; its fields are the keys of [guidance]"
        ) from None
    keys = {
        of.name: of.default if of.default_factory is MISSING else of.default_factory()
        for of in of_dataclass
    }
    if without := [name for name, default in keys.items() if default is MISSING]:
        raise PluginError(
            f"steering law '{law}' has no default for its field '{without[0]}'; its fields are keys"
            " of [guidance], which a scenario may leave out"
        )
    own = {name: of.default for name, of in GuidanceConfig.model_fields.items() if name in keys}
    if other := [name for name, default in own.items() if keys[name] != default]:
        raise PluginError(
            f"steering law '{law}' has {other[0]} = {keys[other[0]]!r}, which is a key of"
            f" [guidance] already, by default {own[other[0]]!r}; give the field another name, or"
            " that default"
        )
    return keys


def _fields_of(law: Any) -> "list[DataclassField[Any]]":
    return [of for of in fields(law) if of.init]


def _type_of(declared: Any, default: object) -> type[Any] | None:
    """Return the plain type of a field: that which it declares, in words where annotations are, or
    that of its default.
    """
    plain: dict[str, type[Any]] = {"bool": bool, "int": int, "float": float, "str": str}
    named = declared if isinstance(declared, str) else getattr(declared, "__name__", "")
    return plain.get(named, float if isinstance(default, float) else None)


def _expected(of: type[Any] | None, value: Any) -> str | None:
    """Return the values that a key takes, in words, if a value has another type; otherwise None."""
    if of is float:
        # Whole numbers may be too large for a float.
        fits = type(value) in (int, float) and abs(value) <= sys.float_info.max
        return None if fits else "a finite number"
    words = {bool: "true or false", int: "a whole number", str: "a word in quotation marks"}
    return None if of is None or type(value) is of else words[of]


class FollowingConfig(Section):
    """How the reference follows a vessel that manoeuvres, in wind that is estimated, from sensors
    and reports.
    """

    @field_validator("margin_law")
    @classmethod
    def _known(cls, law: str | None) -> str | None:
        return law and known_law(law)

    touches_per_hour: Annotated[float, Field(gt=0.0, lt=1.0), FOLLOWS] = 1e-4
    """Probability of touching r_min per flight hour for which the keep-out margin is planned [1/h].
    """
    margin_min_m: Annotated[NonNegative, FOLLOWS] = 3.0
    """Smallest keep-out margin, in calm air and with exact knowledge [m]."""
    speed_ratio_max: Annotated[float, Field(gt=0.0, lt=1.0), FOLLOWS] = 0.97
    """Speed ratio from which the vessel is taken to outrun the UAV [-]."""
    apparent_wind_min_mps: Annotated[
        Positive,
        Need(
            lambda s: s.follows and s.plume_by_wind,
            "a plume that trails with the apparent wind: set plume.direction to 'apparent_wind'",
        ),
    ] = 1.0
    """Apparent wind below which the direction of a plume is not known [m/s]."""
    standoff_m: Annotated[Positive, FOLLOWS, OSCILLATES] = 100.0
    """Distance by which the oscillation in the plume waits farther out than r_CO until the UAV
    tracks it; then it closes in. No radius about the vessel: to circle it, set guidance.mission to
    standoff, which does not use this key [m].
    """
    join_distance_m: Annotated[Positive, _WAY, OSCILLATES] = 150.0
    """Distance from the centre of oscillation at which the approach ends and tracking begins [m].
    """
    tracked_m: Annotated[Positive, _WAY] = 12.0
    """Distance from the reference that counts as tracked: the centre closes in [m]."""
    vessel_acceleration_mps2: Annotated[NonNegative, FOLLOWS] = 0.0
    """Largest acceleration of the vessel between reports, along and across its course together
    [m/s2].
    """
    vessel_speed_max_mps: Annotated[Positive | None, FOLLOWS] = None
    """Largest speed of the vessel over the ground; without limit if not given [m/s]."""
    speed_error_mps: Annotated[NonNegative, FOLLOWS] = 0.0
    """Largest error of the UAV's own velocity through the air and of the wind, together; those of
    sensors count if larger [m/s].
    """
    margin_law: Annotated[
        str | None,
        Need(
            lambda s: s.follows and not s.turbulence.calm,
            "a margin for turbulence: set turbulence.level",
        ),
    ] = None
    """Steering law, with its default parameters, whose tracking in turbulence the margin is planned
    for; if not given, the flight's own."""
    drift_rate_mps: Annotated[NonNegative, FOLLOWS] = 1.0
    """Largest growth of the position error per time in dead reckoning, without satellite
    navigation; errors of sensors count if larger [m/s]."""
    turn_deviation_m: Annotated[NonNegative, FOLLOWS] = 0.0
    """Largest distance by which a reversal of the turn may come nearer than predicted; the
    autopilot's record may raise it [m].
    """
    plume: Annotated[Literal["predicted", "estimated", "told"], EXHAUST] = "predicted"
    """How the axis of exhaust is known: predicted from load, wind and vessel, estimated from a
    sniffer's readings, or told: the true one. In a patrol, of its own flights; those of the oracle
    are told."""
    search: Annotated[
        Literal["information", "ladder"],
        when("following.plume", "estimated", user="a plume that is searched for"),
    ] = "information"
    """How exhaust is searched for: at the most informative height, or up and down a ladder of
    heights.
    """
    distance: Annotated[Literal["closest", "best_measurement"], OSCILLATES, EXHAUST] = "closest"
    """Where exhaust is crossed: as near as the keep-out area allows, or where the sulphur is known
    best after a minute.
    """
    source_height_m: Annotated[tuple[Positive, Positive] | None, OSCILLATES, EXHAUST] = None
    """Lowest and highest possible height of the funnel's mouth, as it is known on board [m]; known
    exactly if not given.
    """
    load: Annotated[tuple[Share, Share] | None, OSCILLATES, EXHAUST] = None
    """Lowest and highest possible load of the engine, as it is known on board; that at the vessel's
    speed if not given [-].
    """
    climb_gradient: Annotated[float, Field(gt=0.0, le=0.3), EXHAUST] = 0.05
    """Largest gradient of climb and descent to another height of the plume [-]."""

    @model_validator(mode="after")
    def _ordered(self) -> "FollowingConfig":
        for name in ("source_height_m", "load"):
            check_ordered(name, getattr(self, name))
        return self
