"""An aircraft that has to turn away while it is fast slows down to V_r in the turn, and keeps out."""

import math

import pytest

from aircraft.fdm import TIME_STEP
from common.physics import METRES_PER_FOOT, STANDARD_GRAVITY, heading_rate_for_bank
from gnc.estimation.error_budget import Bias, ErrorBudget
from gnc.estimation.navigation import TrueNavigation
from gnc.estimation.vessel import Tube
from gnc.guard.guard import Demand, GuardParameters, GuardStatus, KeepoutGuard, SpeedRange
from gnc.numeric import limited, wrap
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.jsbsim.system import HEADING_RATE, write_root

pytestmark = pytest.mark.slow

STEP, RUNS = 0.1, 12

# Disc: radius over the turn radius, speed over V_r, course; where it begins: distance over the turn
# radius, bearing. The law: where it aims off the disc's centre [rad]; pace over V_r. This aircraft
# came 7.0, 2.5 and 0.9 m within the radius as long as turns away were predicted at two constant
# speeds, at a turn radius of 407 m and V_r of 48 m/s.
WORST = [
    (10.0, 0.751, -2.958, 14.262, -0.467, -0.876, 1.111),
    (2.0, 0.640, 0.529, 7.226, -3.101, -0.145, 1.106),
    (0.5, 0.758, -2.622, 6.379, 0.125, -0.282, 1.179),
]


@pytest.fixture(scope="module")
def aircraft(heavy_design, tmp_path_factory):
    """Return a heavy Cessna with its autopilot, level flight, omega_max, and a function that makes
    its guard of a radius.
    """
    schedule, record = heavy_design.design.schedule, heavy_design.record
    level, envelope = schedule.level(schedule.middle), schedule.envelope
    reversal, rate = record["turn_reversal"], heading_rate_for_bank(envelope.bank, level.airspeed)
    aircraft = AutopilotedAircraft(
        schedule.spec, write_root(schedule, tmp_path_factory.mktemp("c172p"))
    )
    overshoot = next(
        r["overshoot"]
        for r in record["responses"]
        if (r["command"], r["kind"]) == ("airspeed", "flown")
    )

    def guard_of(radius):
        parameters = GuardParameters(
            radius=radius,
            heading_rate_max=rate,
            lag=reversal["lag_s"],
            delay=reversal["delay_s"],
            slow_lag=record["heading_rate_lag_s"],
            time_step=STEP,
            errors=ErrorBudget(response=Bias(size=reversal["deviation_max_m"])),
            turn_speed=STANDARD_GRAVITY * math.tan(envelope.bank_max) / rate,
        )
        speeds = SpeedRange(
            speed=level.airspeed,
            bandwidth=record["bandwidths_rad_s"]["airspeed"],
            overshoot=overshoot,
            time_step=STEP,
        )
        return KeepoutGuard(parameters, speeds)

    return aircraft, level, rate, guard_of


@pytest.mark.parametrize("case", WORST)
def test_a_fast_aircraft_keeps_out_though_it_slows_down_in_the_turn(aircraft, case):
    flown, level, rate, guard_of = aircraft
    radii, share, heading, far, bearing, lead, faster = case
    turn_radius = level.airspeed / rate
    guard, statuses = guard_of(radii * turn_radius), set()
    flown.release(level.state(), airspeed=level.airspeed, altitude=level.altitude)
    node = flown.fdm.node
    velocity = [node(f"velocities/v-{axis}-fps").get_double_value for axis in ("north", "east")]
    turning = node(HEADING_RATE).get_double_value
    disc = [far * turn_radius * math.cos(bearing), far * turn_radius * math.sin(bearing)]
    moving = [
        share * level.airspeed * math.cos(heading),
        share * level.airspeed * math.sin(heading),
    ]
    own, place, nearest, time = TrueNavigation(), [0.0, 0.0], math.inf, 0.0
    while time < 80.0:
        north, east = (METRES_PER_FOOT * of() for of in velocity)
        own.update((*place, north, east, turning()))
        aim = math.atan2(disc[1] - place[1], disc[0] - place[0]) + lead
        wanted = limited(2.0 * wrap(aim - own.course), rate)
        demand = Demand(time, wanted, faster * level.airspeed)
        guarded = guard.filter(demand, own, (Tube(time, *disc, *moving),))
        statuses.add(guarded.status)
        flown.command_heading_rate(guarded.heading_rate)
        flown.command_airspeed(guarded.pace)
        for _ in range(RUNS):
            flown.run()
            place = [
                p + METRES_PER_FOOT * of() * TIME_STEP
                for p, of in zip(place, velocity, strict=True)
            ]
        disc = [p + v * STEP for p, v in zip(disc, moving, strict=True)]
        time += STEP
        nearest = min(nearest, math.dist(disc, place) - radii * turn_radius)
    assert GuardStatus.INTERVENING in statuses
    assert 0.0 <= nearest < 0.05 * turn_radius
