"""The predicted spread of the tracking error by turbulence in a study's flights."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from aircraft.fdm import Fdm
from aircraft.spec import AircraftSpec
from aircraft.weather import TURBULENCE, low_altitude_turbulence
from common.physics import METRES_PER_FOOT
from gnc.errors import InfeasibleError
from gnc.reference.reference import Orbit
from innerloop.store import Designed
from scenarios.errors import InputError
from scenarios.planning.guidance import speed_hold, tracking_parameters
from scenarios.planning.limits import omega_max
from scenarios.planning.margin.keepout_margin import SpreadTable
from scenarios.planning.reference import oscillation_at
from scenarios.planning.scaling import scaled_law_defaults
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup

SPREAD_RATIOS = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Speed ratios at which the spread is predicted [-]; it hardly depends on them."""

Key = tuple[str, str, str]
"""Level of turbulence, and the guidance and the reference in it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedSpreads:
    """The predicted spread of each kind of flight in turbulence.

    Attributes
    ----------
    tables : by level of turbulence, guidance and reference
    refused : reason why there is no spread, where guidance or reference cannot be flown
    defaults : of the keys of the project's own steering laws, scaled to the aircraft, by their
        dotted names
    """

    tables: Mapping[Key, SpreadTable] = field(default_factory=dict)
    refused: Mapping[Key, str] = field(default_factory=dict)
    defaults: Mapping[str, float] = field(default_factory=dict)

    def __call__(self, scenario: Scenario) -> SpreadTable | None:
        """Return the spread of a scenario's flights; None in calm air and for a kinematic vehicle.

        Raises
        ------
        InputError : it was not predicted
        InfeasibleError : it cannot be flown
        """
        if scenario.turbulence.level == "none" or scenario.fidelity == "kinematic":
            return None
        if (key := _key(scenario, self.defaults)) in self.refused:
            raise InfeasibleError(self.refused[key])
        if key not in self.tables:
            raise InputError(
                "guidance is sampled from a continuous distribution in turbulence, where each"
                " value takes a margin of its own; give it a choice of values instead"
            )
        return self.tables[key]


def predicted_spreads(
    scenarios: Iterable[Scenario], found: Designed | None, setup: VehicleSetup | None
) -> PredictedSpreads:
    """Return the predicted spread of each of some scenarios with turbulence; empty without an
    aircraft.
    """
    if found is None or setup is None:
        return PredictedSpreads()
    defaults = scaled_law_defaults(found.design.schedule.envelope)
    kinds = {
        _key(scenario, defaults): _planned_for(scenario, defaults)
        for scenario in scenarios
        if scenario.turbulence.level != "none" and scenario.fidelity != "kinematic"
    }
    tables, refused = dict[Key, SpreadTable](), dict[Key, str]()
    for key, planned in kinds.items():
        try:
            tables[key] = _spread_table(planned, found, setup)
        except InfeasibleError as error:
            refused[key] = str(error)
    return PredictedSpreads(tables=tables, refused=refused, defaults=defaults)


def _key(scenario: Scenario, defaults: Mapping[str, float]) -> Key:
    planned = _planned_for(scenario, defaults)
    return (
        scenario.turbulence.level,
        planned.guidance.model_dump_json(),
        planned.reference.model_dump_json(),
    )


def _planned_for(scenario: Scenario, defaults: Mapping[str, float]) -> Scenario:
    """Return the scenario with the steering law for which its margin is planned: its law, or
    another with default parameters.
    """
    law = scenario.following.margin_law
    if law is None:
        return scenario
    # The prediction does not depend on the mission, and not every law supports every mission.
    return with_values(
        scenario,
        {
            "guidance.law": law,
            **defaults,
            "guidance.mission": "follow",
            "following.margin_law": None,
        },
    )


def _spread_table(scenario: Scenario, found: Designed, setup: VehicleSetup) -> SpreadTable:
    # They need python-control, which a flight in calm air does not need.
    from scenarios.planning.margin.tracking_spread import tracking_spreads
    from scenarios.planning.margin.turn_spread import turn_deviation

    schedule = found.design.schedule
    air = low_altitude_turbulence(
        scenario.altitude, TURBULENCE[scenario.turbulence.level].wind_at_20ft
    )
    tracking = tracking_parameters(scenario, setup)
    hold = speed_hold(scenario, setup)
    span = _wing_span(schedule.spec)
    orbits = dict(_orbits(scenario))
    return SpreadTable(
        speed_ratios=tuple(orbits),
        spreads=tracking_spreads(schedule, air, [*orbits.values()], tracking, hold, span=span),
        turning=turn_deviation(
            schedule,
            air,
            speed=scenario.guidance.airspeed_mps,
            heading_rate=omega_max(scenario.guidance),
            time_step=tracking.time_step,
            span=span,
            key="turbulence.level",
        ),
    )


def _orbits(scenario: Scenario) -> Iterator[tuple[float, Orbit]]:
    """Yield the orbit at each speed ratio at which the reference's shape has one; the lowest ratio
    has one if any does.
    """
    for nu in SPREAD_RATIOS:
        try:
            yield nu, oscillation_at(scenario.guidance, scenario.reference, nu)
        except InfeasibleError:
            if nu == SPREAD_RATIOS[0]:
                raise


def _wing_span(spec: AircraftSpec) -> float:
    """Return the wing's span [m]."""
    return Fdm(spec).read("metrics/bw-ft") * METRES_PER_FOOT
