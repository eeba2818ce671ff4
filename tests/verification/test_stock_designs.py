"""Designs of JSBSim's own aircraft: what is required of every design, on those that are designed in
seconds.
"""

import math

import pytest

from aircraft.fleet.find import find_spec
from innerloop.designer import design_autopilot
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.responses import flown_step, measure_lag, model_step
from innerloop.jsbsim.system import write_root

pytestmark = pytest.mark.slow

STOCK = ("T37", "737", "c172p")
ALTITUDE = 60.0  # m, of the designs that tests share
TURN = 0.5
"""Of the heading rate that the study's turn has, in the step that is flown [-]."""


@pytest.fixture(params=STOCK)
def stock(request, designs, tmp_path):
    """A design, and the lag of its heading rate [s]."""
    if request.param == "737":
        # No flight of other tests asks for its record, and the search over reversals is half of the
        # time that this takes.
        design = design_autopilot(find_spec("737"), ALTITUDE)
        schedule = design.schedule
        aircraft = AutopilotedAircraft(schedule.spec, write_root(schedule, tmp_path / "lag"))
        level = schedule.level(schedule.middle)
        return design, measure_lag(aircraft, level, schedule.envelope.bank)
    # The Cessna is heavier by 150 lb: that of docs/scripts/aircraft_directory.py, which other tests
    # need anyway.
    is_heavy = request.param == "c172p"
    found = request.getfixturevalue("heavy_design") if is_heavy else designs(request.param)
    return found.design, found.record["heading_rate_lag_s"]


def test_a_design_has_its_margins_turns_as_its_model_and_leaves_room_for_the_study(stock, tmp_path):
    design, lag = stock
    schedule, weights = design.schedule, design.schedule.weights
    assert_margins(design.checks)
    # 2 zeta/omega_n of a second-order model; the aircraft follows it within a tenth.
    assert lag == pytest.approx(2.0 * weights.model_damping / weights.model_frequency, rel=0.1)
    envelope = schedule.envelope
    assert envelope.stall > 0.0
    # 1.3 times above stall, more in the steepest turn; and at least 12 % from end to end, or there
    # is nothing to schedule.
    assert envelope.airspeed_min > 1.3 * envelope.stall
    assert envelope.airspeed_max / envelope.airspeed_min > 1.12
    aircraft = AutopilotedAircraft(schedule.spec, write_root(schedule, tmp_path / "turns"))
    for sign in (1.0, -1.0):
        assert_it_turns_as_its_model(schedule, aircraft, sign)


def assert_margins(checks):
    # 25 points of the grid and 40 half-way between, the aircraft as modelled and changed in seven
    # ways.
    assert len(checks) == 75 * 8
    for check in checks:
        assert check.stable
        # MIL-F-9490D's 6 dB and 45 degrees; of a changed aircraft, 4 dB and 30 degrees.
        gain_db, phase_deg = (6.0, 45.0) if check.case == "as modelled" else (4.0, 30.0)
        single = [margin for margin in check.margins if margin.loop != "all controls"]
        assert {margin.loop for margin in single} == {
            "elevator", "aileron", "throttle", "rudder", "airspeed", "altitude", "heading_rate", "sideslip",
        }  # fmt: skip
        assert min(margin.gain_db for margin in single) >= gain_db, check.describe()
        assert min(margin.phase_deg for margin in single) >= phase_deg, check.describe()


def assert_it_turns_as_its_model(schedule, aircraft, sign):
    """Assert how it flies half of the turn of the study."""
    level = schedule.level(schedule.middle)
    size = sign * TURN * 9.80665 * math.tan(schedule.envelope.bank) / level.airspeed
    duration = 20.0 / schedule.weights.model_frequency
    flown = flown_step(aircraft, level, "heading_rate", size, duration)
    model = model_step(schedule, size, duration)
    # The requirement on every design.
    assert flown.overshoot() < model.overshoot() + 0.1
    # It gets there, and as quickly as its model within a fifth.
    assert flown.rise_time() == pytest.approx(model.rise_time(), rel=0.2)
    assert flown.channels["heading_rate"][-1] == pytest.approx(size, rel=0.02)
    # Sideslip is what the rudder is for: under a degree and a half on the way into a bank of 15
    # degrees and more.
    assert flown.largest("beta") < math.radians(1.5)
    # Altitude keeps to what a pilot is allowed in a turn, 100 ft.
    assert flown.largest("altitude") < 30.0
