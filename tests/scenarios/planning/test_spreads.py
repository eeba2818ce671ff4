"""The margin of a flight that follows a plume: of the turbulence that it has."""

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest
from flight_cases import plan, scenario

from aircraft.fleet.x8 import X8
from scenarios.engine.run_directory import RunDirectory
from scenarios.experiment.requests import Experiment
from scenarios.planning.margin.keepout_margin import Spread, SpreadTable
from scenarios.planning.scaling import scaled
from scenarios.planning.spreads import SPREAD_RATIOS, predicted_spreads
from scenarios.vehicles.vehicle_setup import aircraft_setup

pytestmark = pytest.mark.slow

LEVELS = ("none", "light", "moderate")


TABLED = SpreadTable(
    speed_ratios=(0.2, 0.6),
    spreads=tuple(
        Spread(
            along=s,
            across=s,
            radial=s,
            radial_rate=s,
            airspeed=s,
            airspeed_rate=s,
            airspeed_limit=100.0,
        )
        for s in (1.0, 2.0)
    ),
)


@pytest.fixture(scope="module")
def x8(designs, tmp_path_factory):
    """The design that other tests have too, and what flights need of it."""
    found = designs("x8")
    flown = gusty(level="none")
    return found, aircraft_setup(
        found, flown, RunDirectory(tmp_path_factory.mktemp("x8")), settings=[flown]
    )


def gusty(**turbulence):
    return scenario(fidelity="six_dof", turbulence=turbulence)


def sampling(key, choice):
    draws = [{"key": key, "choice": list(choice)}]
    return scenario(fidelity="six_dof", flights=len(choice), draws=draws)


def test_an_experiment_that_samples_its_turbulence_plans_each_levels_own_margin(x8, monkeypatch):
    found, setup = x8
    # Two of five, for time's sake.
    monkeypatch.setattr("scenarios.planning.spreads.SPREAD_RATIOS", SPREAD_RATIOS[1:3])
    experiment = Experiment("trial", sampling("turbulence.level", LEVELS))
    spreads = predicted_spreads(experiment.settings(), found, setup)
    # Still air has no spread.
    assert {level for level, *_ in spreads.tables} == {"light", "moderate"}
    assert {table.speed_ratios for table in spreads.tables.values()} == {SPREAD_RATIOS[1:3]}
    margins = {}
    for number, level in enumerate(LEVELS):
        request = experiment.request(number)
        assert request.scenario.turbulence.level == level
        margins[level] = plan(
            request.scenario, seed=request.seed, setup=setup, spreads=spreads
        ).margin
        # The same as of a scenario that has this turbulence in every flight.
        alone = gusty(level=level)
        own = predicted_spreads([alone], found, setup)
        assert {level for level, *_ in own.tables} == {level} - {"none"}
        assert plan(alone, setup=setup, spreads=own).margin == margins[level]
    # MIL-F-8785C: twice the wind at 20 feet has twice the intensity, and the loop is linear; in
    # still air the least is kept.
    assert margins["none"].tracking_sigma == 0.0
    assert margins["moderate"].tracking_sigma == pytest.approx(
        2.0 * margins["light"].tracking_sigma, rel=1e-6
    )
    assert margins["none"].total < margins["light"].total < margins["moderate"].total


@pytest.mark.parametrize("airspeed", [19.42, 60.0])
def test_the_margin_of_another_law_is_planned_with_parameters_scaled_to_the_aircraft(
    airspeed, monkeypatch
):
    monkeypatch.setattr("scenarios.planning.spreads._spread_table", lambda *_: TABLED)
    envelope = replace(X8.envelope, airspeed=airspeed)
    found = SimpleNamespace(design=SimpleNamespace(schedule=SimpleNamespace(envelope=envelope)))
    trial = scenario(
        fidelity="six_dof", turbulence={"level": "light"}, following={"margin_law": "cascade"}
    )
    flown = scaled(trial, envelope)
    spreads = predicted_spreads([flown], found, SimpleNamespace())
    ((_, planned, _),) = spreads.tables
    guidance, keys = (
        json.loads(planned),
        ("look_ahead_m", "epsilon_per_m", "gain_per_s", "steering_max_rad_s"),
    )
    # Those of the flight itself, whose law is the same.
    assert [guidance[key] for key in keys] == [getattr(flown.guidance, key) for key in keys]
    # R is 60 m for the X8, and grows with the square of the airspeed at the same bank.
    assert guidance["look_ahead_m"] == pytest.approx(60.0 * (airspeed / 19.42) ** 2)
    assert spreads(flown) is TABLED
