"""Where an aircraft can fly the study: stall, banks by class, reserve at the ends."""

import math
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest

from aircraft.envelope import find_envelope, first_trim, with_reserve_note
from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.fleet.x8 import X8
from aircraft.spec import BANK_RESERVE, MODELS, AircraftError
from aircraft.state import RigidBodyState, body_velocity
from aircraft.trim import TrimOutcome, search_trim
from common.physics import NEWTONS_PER_POUND

ALTITUDE = 100.0
STEEPEST = 1.1  # the autopilot's tables reach a tenth past its largest bank


@pytest.fixture(scope="module")
def jet():
    return Fdm(find_spec("T37"))


@pytest.fixture(scope="module")
def envelope(jet):
    return find_envelope(jet, ALTITUDE)


def test_a_stated_envelope_has_a_note_where_an_equilibrium_lacks_a_reserve_and_none_elsewhere():
    fdm = Fdm(X8)
    slow = [
        search_trim(fdm, airspeed=11.0, altitude=ALTITUDE, bank=math.radians(bank))
        for bank in (0.0, 55.0)
    ]
    # Beyond nine tenths of its travel in the turn, and not in level flight.
    assert slow[1].outcome is TrimOutcome.CONVERGED
    assert slow[1].inputs["elevator"] < -0.9 < slow[0].inputs["elevator"]
    assert with_reserve_note(X8.envelope, slow[:1], X8) is X8.envelope
    noted = with_reserve_note(X8.envelope, slow, X8)
    assert replace(noted, notes=(), stall=0.0) == replace(X8.envelope, stall=0.0)
    (note,) = noted.notes
    elevator = slow[1].inputs["elevator"]
    assert "no control reserve at 1 of 2 equilibria" in note
    assert f"11 m/s and 55 deg of bank take {elevator:.2f} of elevator; -0.9 to 0.9" in note


@pytest.mark.parametrize(("key", "found"), [("emptywt", "weight is -"), ("wingarea", "area is 0")])
def test_a_model_without_weight_or_wing_area_is_refused(tmp_path, key, found):
    root = shutil.copytree(MODELS, tmp_path / "models")
    file = root / "aircraft" / "x8" / "x8.xml"
    number = "-3.0" if found.endswith("-") else "0.0"
    text = re.sub(rf"(<{key}[^>]*>)[^<]*", rf"\g<1>{number}", file.read_text(encoding="utf-8"))
    file.write_text(text, encoding="utf-8")
    with pytest.raises(AircraftError, match=rf"{found}.* must be above 0: correct {key} in"):
        first_trim(Fdm(replace(X8, root=root)), ALTITUDE)


def test_the_stall_is_where_the_largest_lift_just_carries_the_weight(jet, envelope):
    # Independently: at the stall airspeed itself, over all angles of attack, by steps ten times
    # finer than the search's, lift just reaches the weight. Coefficients are the same at that speed
    # (Mach 0.12 against 0.2); 1 degree of steps at the flat top of lift is 1 %, its root half of
    # it.
    lifts = []
    with jet.frozen():
        for alpha in np.radians(np.arange(0.0, 23.0, 0.1)):
            velocity = body_velocity(envelope.stall, float(alpha), 0.0)
            jet.place(
                RigidBodyState(
                    altitude=ALTITUDE, roll=0.0, pitch=float(alpha), velocity_body=velocity
                )
            )
            jet.step(2)
            lifts.append(-jet.read("forces/fwz-aero-lbs") * NEWTONS_PER_POUND)
    weight = jet.read("inertia/weight-lbs") * NEWTONS_PER_POUND
    assert max(abs(lift) for lift in lifts) == pytest.approx(weight, rel=0.03)


def test_the_slowest_airspeed_leaves_three_tenths_above_stall_in_the_steepest_turn(envelope):
    steepest = STEEPEST * (envelope.bank + BANK_RESERVE)
    # In a turn stall rises with the root of the load, 1/cos(bank).
    assert envelope.airspeed_min == pytest.approx(
        1.3 * envelope.stall / math.sqrt(math.cos(steepest))
    )
    assert envelope.airspeed_max <= 1.6 * envelope.airspeed_min * (1.0 + 1e-9)
    assert envelope.airspeed_min < envelope.airspeed < envelope.airspeed_max
    assert len(envelope.design_airspeeds) == 5
    assert envelope.design_airspeeds[-1] == pytest.approx(envelope.airspeed_max)
    assert envelope.bank_max == pytest.approx(envelope.bank + math.radians(5.0))


def test_both_ends_fly_level_and_steepest_turns_with_reserve(jet, envelope):
    steepest = STEEPEST * envelope.bank_max
    for airspeed in (envelope.airspeed_min, envelope.airspeed_max):
        for bank in (0.0, steepest, -steepest):
            found = search_trim(jet, airspeed=airspeed, altitude=ALTITUDE, bank=bank)
            assert found.outcome is TrimOutcome.CONVERGED
            assert 0.03 <= found.inputs["throttle"] <= 0.95
            assert max(abs(found.inputs[name]) for name in ("elevator", "aileron", "rudder")) <= 0.9


def test_an_aircraft_that_trims_nowhere_is_refused_with_what_holds_it():
    # At 25 km there is a thirtieth of the air, which neither the T-37's wing nor its engines can
    # live on.
    with pytest.raises(AircraftError, match=r"'T37' does not trim: .* at .* m/s"):
        first_trim(Fdm(find_spec("T37")), 25_000.0)
