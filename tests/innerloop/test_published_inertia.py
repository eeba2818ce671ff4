"""The X8's autopilot on an X8 with the inertia that its authors print."""

import re
import shutil

import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.linearise import linearise
from aircraft.spec import MODELS
from aircraft.trim import trim
from innerloop.law import ControlLaw, linear_controller
from innerloop.margins import Loops

pytestmark = pytest.mark.slow

PRINTED = {"ixx": 1.229, "iyy": 0.1702, "izz": 0.8808, "ixz": 0.9343}
"""Of the authors' parameter file, "based on very rough initial tests" [kg m^2]."""


def worst_margins(schedule, root):
    """Return whether all loops are stable, and the least margins [dB, deg] over the envelope."""
    law, fdm, stable, gains, phases = ControlLaw(schedule), Fdm(X8, root), [], [], []
    for airspeed in schedule.airspeeds:
        for bank in (schedule.gain_banks[0], 0.0, schedule.gain_banks[-1]):
            point = trim(fdm, airspeed=airspeed, altitude=100.0, bank=bank)
            loops = Loops(linearise(fdm, point), linear_controller(law, point), schedule.delay)
            margins = loops.margins()
            stable.append(loops.stable)
            gains.append(min(margin.gain_db for margin in margins))
            phases.append(min(margin.phase_deg for margin in margins))
    return all(stable), min(gains), min(phases)


@pytest.mark.parametrize(
    ("ixz", "margins"),
    [
        # 3.7 times the model's moment in roll and 2.2 in yaw, without the product: as much as is
        # required of an aircraft with a fifth more. With the model's, 11.5 dB and 53.4 degrees.
        (0.0, (9.01, 35.1)),
        # Less than is required of an aircraft that can exist: no body has the printed product.
        (PRINTED["ixz"], (2.63, 22.3)),
    ],
)
def test_the_design_is_stable_with_the_printed_inertia(x8_schedule, tmp_path, ixz, margins):
    root = shutil.copytree(MODELS, tmp_path / "models")
    file = root / "aircraft" / "x8" / "x8.xml"
    text = file.read_text(encoding="utf-8")
    for tag, value in (PRINTED | {"ixz": ixz}).items():
        text, count = re.subn(rf"(<{tag}[^>]*>)[^<]*(</{tag}>)", rf"\g<1>{value}\g<2>", text)
        assert count == 1, tag
    file.write_text(text, encoding="utf-8")
    stable, gain, phase = worst_margins(x8_schedule, root)
    assert stable
    assert (gain, phase) == pytest.approx(margins, abs=0.5)
