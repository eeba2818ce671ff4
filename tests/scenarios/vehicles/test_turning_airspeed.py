"""Up to what airspeed a heading rate can be flown at the autopilot's largest bank."""

import math

import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.trim import trim
from innerloop.flight.turn_reversal import TurnReversalResponse
from scenarios.vehicles.vehicle_setup import VehicleSetup, _slower_turns


@pytest.mark.parametrize("heading_rate", [0.45, 0.505, 0.58])
def test_the_slower_turn_at_the_largest_bank_is_as_fast_as_is_said_and_hardly_faster(
    x8_schedule, heading_rate
):
    setup = VehicleSetup(
        lag=0.4, reversal=TurnReversalResponse(delay=0.26, lag=0.26), response_error=3.0, airspeed_bandwidth=1.0, airspeed_min=15.0,
        airspeed_max=25.0, turn_airspeeds=tuple(x8_schedule.airspeeds), turn_rates=_slower_turns(x8_schedule),
    )  # fmt: skip
    airspeed, bank = setup.turning_airspeed(heading_rate), x8_schedule.envelope.bank_max
    found = [
        trim(
            Fdm(X8), airspeed=airspeed, altitude=x8_schedule.altitude, bank=side * bank, start=turn
        )
        for side, turn in ((1.0, x8_schedule.trims[2][-1]), (-1.0, x8_schedule.trims[2][0]))
    ]
    slower = min(abs(turn.yaw_rate) for turn in found)
    assert math.degrees(bank) == pytest.approx(50.0)
    # Between trims at 45 and 55 deg and 2.5 m/s apart the turn is as fast or faster by 0.3 %.
    assert heading_rate <= slower <= 1.003 * heading_rate
