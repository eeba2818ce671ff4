"""Plans of other aircraft and of their turbulence, and scenarios that are scaled to an aircraft."""

import math

import numpy as np
import pandas as pd
import pytest
import typer
from flight_cases import plan, scenario
from pydantic import BaseModel

from aircraft.spec import Envelope
from innerloop.store import DesignError
from scenarios.engine.run_directory import RunDirectory
from scenarios.experiment.requests import Experiment
from scenarios.flight.closed_loop import fly, release
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import COLUMNS
from scenarios.planning.missions import plan_flight
from scenarios.planning.scaling import scaled
from scenarios.planning.spreads import SPREAD_RATIOS, predicted_spreads
from scenarios.run import command
from scenarios.scenario.files import load_study, with_values
from scenarios.vehicles.vehicle_setup import aircraft_setup, kinematic_setup
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow


SHORT = ["flight.crossings=2", "comparison.variants=[]"]


@pytest.mark.usefixtures("sketched")
def test_a_design_that_is_refused_is_rows_with_its_reason_and_exit_status_1(
    monkeypatch, tmp_path, capsys
):
    def designed(*_):
        raise DesignError("aircraft 'x8': no design has 6 dB. It is not flown")

    monkeypatch.setattr("scenarios.vehicles.vehicle_setup.designed", designed)
    with pytest.raises(typer.Exit) as ended:
        command("sweep_nu", out=tmp_path, jobs=1, overrides=[*SHORT, "sweep.nu=[0.3, 0.5]"])
    assert ended.value.exit_code == 1
    printed = capsys.readouterr()
    assert printed.out.count("trim_failed: aircraft 'x8': no design has 6 dB. It is not flown") == 2
    assert "Traceback" not in printed.err
    summary = pd.read_csv(tmp_path / "summary.csv")
    assert set(summary["outcome"]) == {"trim_failed"}
    assert not summary["criteria_met"].any()
    assert manifest_of(tmp_path)["state"] == "complete"
    # The report is built all the same, and says why.
    assert "Nothing was flown" in (tmp_path / "report.html").read_text(encoding="utf-8")


LEVELS = ("none", "light", "moderate")


def gusty(**turbulence):
    return scenario(fidelity="six_dof", turbulence=turbulence)


def test_an_experiment_that_samples_its_turbulence_plans_each_levels_own_margin(
    designs, tmp_path, monkeypatch
):
    found, flown = designs("x8"), gusty(level="none")
    setup = aircraft_setup(found, flown, RunDirectory(tmp_path), settings=[flown])
    # Two of five, for time's sake.
    monkeypatch.setattr("scenarios.planning.spreads.SPREAD_RATIOS", SPREAD_RATIOS[1:3])
    draws = [{"key": "turbulence.level", "choice": LEVELS}]
    experiment = Experiment("trial", scenario(fidelity="six_dof", flights=len(LEVELS), draws=draws))
    spreads = predicted_spreads(experiment.settings(), found, setup)
    # Still air has no spread.
    assert {level for level, *_ in spreads.tables} == {"light", "moderate"}
    assert {table.speed_ratios for table in spreads.tables.values()} == {SPREAD_RATIOS[1:3]}
    margins = {}
    for number, level in enumerate(LEVELS):
        request = experiment.request(number)
        assert request.scenario.turbulence.level == level
        how = {"seed": request.seed, "setup": setup, "spreads": spreads}
        margins[level] = plan(request.scenario, **how).margin
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


SPEED, GRAVITY = 19.42, 9.80665

NOT_SCALED = {
    # The aircraft's own.
    "guidance.airspeed_mps", "following.turn_deviation_m",
    # World and equipment, and what is written for a circle about which the scenario says
    # everything.
    "vessel.speed_mps", "vessel.gap_max_s", "air.background_s", "plume.source_height_m",
    "keepout.radius_m", "reference.radius_m", "wind.speed_mps", "wind.roughness_m", "wind.height_m",
    "turbulence.gust_speed_mps", "turbulence.gust_length_s", "reports.interval_s",
    "reports.position_sigma_m", "wind.stability_per_s", "reports.velocity_sigma_mps",
    "reports.latency_max_s", "sensors.position_sigma_m", "sensors.velocity_sigma_mps",
    "sensors.airspeed_sigma_mps", "sensors.airspeed_bias_mps", "vessel.length_m", "vessel.beam_m",
    "vessel.stack_from_bow_m", "vessel.stack_from_port_m", "vessel.antenna_from_bow_m",
    "vessel.antenna_from_port_m", "reports.turn_rate_sigma_deg_s", "fault.at_s",
    "fault.vessel_data_s", "fault.satellite_navigation_s",
    # What a ship does, how well it is known, and how often the keep-out area may be touched.
    "following.apparent_wind_min_mps", "following.vessel_acceleration_mps2",
    "following.vessel_speed_max_mps", "following.speed_error_mps", "following.drift_rate_mps",
    "following.touches_per_hour", "statistics.distance_quantile_width_m",
    # What an arena of laws tunes and measures, for the aircraft that its file names.
    "arena.tuning_duration_s", "arena.error_max_m", "arena.window_s", "arena.effort_weight_m_s",
    # Where ships are, and how long they take, for the aircraft that a patrol's file names.
    "patrol.endurance_s", "patrol.area_m", "patrol.separation_m", "patrol.clearance_m",
    "patrol.patience_s", "patrol.service_s", "patrol.service_deviation_s",
    "reference.standoff_radius_m",
    # The paper's vehicle has no lag, however fast it turns.
    "kinematic.heading_rate_lag_s",
    # The budget of a search on this machine.
    "search.time_s",
    # The simulation runs at 120 Hz for every aircraft.
    "guidance.rate_hz", "flight.log_rate_hz",
    # Not set by default; who sets them means what they say.
    "flight.after_settling_s", "flight.measured_s", "flight.altitude_min_m",
    "flight.altitude_max_m", "guidance.heading_rate_max_rad_s", "start.place_m", "start.range_m",
    "criteria.tracking_error_end_m", "criteria.crossing_interval_s", "criteria.crossing_distance_m",
    "following.source_height_m", "flight.altitude_m", "criteria.time_to_find_s",
}  # fmt: skip
"""Keys with a length or a time in them that are what they are for every aircraft."""

DIMENSIONS = {
    "_per_hour": (0, -1), "_mps2": (1, -2), "_per_m2": (-2, 0), "_per_m": (-1, 0),
    "_per_s": (0, -1), "_rad_s": (0, -1), "_deg_s": (0, -1), "_mps": (1, -1), "_hz": (0, -1),
    "_m": (1, 0), "_s": (0, 1),
}  # fmt: skip
"""Powers of length and time in a unit, by the suffix that names it (house style); the first that
fits.
"""


def aircraft(time, length):
    """Return an aircraft whose units are so many times the defaults': V = 19.42 length/time, and
    tan(bank) = omega_max V/g.
    """
    airspeed = SPEED * length / time
    bank = math.atan(GRAVITY / SPEED / time * airspeed / GRAVITY)
    return Envelope(airspeed_min=1.0, airspeed_max=300.0, airspeed=airspeed, bank=bank)


def keys(scenario):
    """Return every key of a scenario's sections and its value."""
    sections = {name: getattr(scenario, name) for name in type(scenario).model_fields}
    return {
        f"{name}.{key}": getattr(section, key)
        for name, section in sections.items()
        if isinstance(section, BaseModel)
        for key in type(section).model_fields
    }


def dimension(key):
    # The one exception, explained where it is scaled: altitude follows pitch at a given speed, not
    # the turn.
    if key == "criteria.altitude_error_max_m":
        return 1, -1
    return next((powers for suffix, powers in DIMENSIONS.items() if key.endswith(suffix)), None)


def test_every_key_with_a_length_or_a_time_is_scaled_by_its_unit_or_said_not_to_be():
    scenario = load_study("sweep_nu")
    before, after = keys(scenario), keys(scaled(scenario, aircraft(time=2.0, length=3.0)))
    dimensional = {key for key in before if dimension(key)}
    # A list that names keys that are gone, or that are without a unit, would be no decision.
    assert dimensional >= NOT_SCALED
    for key in before:
        powers = None if key in NOT_SCALED else dimension(key)
        if before[key] is None:
            # It is derived from another key, which is scaled.
            assert after[key] is None, key
        elif powers:
            factor = 3.0 ** powers[0] * 2.0 ** powers[1]
            assert after[key] == pytest.approx(np.multiply(before[key], factor), rel=1e-12), key
        elif key not in ("guidance.airspeed_mps", "guidance.bank_deg"):
            assert after[key] == before[key], key


def in_own_units(time, length, *overrides, nu, lag):
    """Return a flight of a scenario that is scaled to an aircraft, its keep-out area and its steps
    scaled by hand, in the units of the aircraft.
    """
    by_hand = {
        "keepout.radius_m": 200.0 * length, "guidance.rate_hz": 20.0 / time,
        "flight.log_rate_hz": 10.0 / time, "kinematic.heading_rate_lag_s": lag * time,
    }  # fmt: skip
    words = ["fidelity=kinematic", f"sweep.nu=[{nu}]", "comparison.variants=[]", *overrides]
    study = load_study("sweep_nu", words, refusing=False)
    settings = with_values(scaled(study, aircraft(time, length)), by_hand)
    request = Experiment("sweep_nu", settings).request(0)
    setup = kinematic_setup(request.scenario)
    plan = plan_flight(request.scenario, flight_id="x", seed=request.seed, setup=setup)
    record = fly(plan, release(plan, setup))
    assert record.outcome is Outcome.COMPLETED
    unit = {"_mps": length / time, "_rad_s": 1.0 / time, "_s": time, "_m": length}
    # Altitude is the plume's, and not of the turn; course is an angle, compared as its cosine and
    # sine by the velocities.
    level = ("altitude_m", "altitude_command_m", "climb_rate_mps")
    flown = [name for name in COLUMNS if name.endswith(tuple(unit)) and name not in level]
    scale = [next(size for suffix, size in unit.items() if name.endswith(suffix)) for name in flown]
    return record.history[:, [COLUMNS.index(name) for name in flown]] / scale


@pytest.mark.parametrize(
    ("nu", "lag", "overrides"),
    [
        (0.95, 0.3, ["guidance.preview=false"]),
        (0.5, 0.0, ["guidance.law=lyapunov"]),
        (0.5, 0.3, ["guidance.tuning=bounded", "guidance.reserve=0.4"]),
    ],
)
def test_in_its_own_units_every_aircraft_flies_the_same_flight(monkeypatch, nu, lag, overrides):
    base = in_own_units(1.0, 1.0, *overrides, nu=nu, lag=lag)
    # Plans are as often as the steps of the other.
    monkeypatch.setattr("scenarios.planning.limits.PLAN_PERIOD", 1.0)
    other = in_own_units(2.0, 4.0, *overrides, nu=nu, lag=lag)
    assert len(base) > 1000
    # Twice the speed at 45 degrees of bank: factors are powers of two, so even roundings scale.
    # Equal to the last bit, whatever the law does with a difference.
    np.testing.assert_array_equal(other, base)
