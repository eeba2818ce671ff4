"""Aircraft whose mass, inertia or controls' effectiveness are not as modelled."""

import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.fleet.x8 import X8
from aircraft.model import copy_model, perturb
from aircraft.state import RigidBodyState
from innerloop.flight.turn_reversal import REVERSAL_PERTURBATIONS, perturbed_aircraft
from tests.aircraft.split_model import split_model


@pytest.fixture(scope="module")
def flown(x8_root, x8_schedule):
    """Return the X8 of each case, a tenth of a second into a turn."""
    level = x8_schedule.level(x8_schedule.middle)
    aircraft = {
        name: perturbed_aircraft(X8, x8_root, by) for name, by in REVERSAL_PERTURBATIONS.items()
    }
    for each in aircraft.values():
        each.release(level.state(), airspeed=level.airspeed, altitude=level.altitude)
        each.command_heading_rate(0.3)
        for _ in range(12):
            each.run()
    return aircraft


def value(aircraft, name):
    return aircraft.fdm.node(name).get_double_value()


# Of the model file: 3.364 kg and 0.335, 0.140, 0.400 kg m^2; a kilogram weighs 2.2046226 lb, and 1
# slug ft^2 is 1.3558179 kg m^2, but by 9e-5 in JSBSim.
@pytest.mark.parametrize("case", REVERSAL_PERTURBATIONS)
def test_mass_and_inertia_are_as_modelled_times_the_factor(flown, case):
    by = REVERSAL_PERTURBATIONS[case]
    assert value(flown[case], "inertia/weight-lbs") == pytest.approx(
        3.364 * 2.2046226 * by.mass, rel=1e-6
    )
    for axis, moment in (("xx", 0.335), ("yy", 0.140), ("zz", 0.400)):
        assert value(flown[case], f"inertia/i{axis}-slugs_ft2") == pytest.approx(
            moment / 1.3558179 * by.inertia, rel=1e-4
        )


@pytest.mark.parametrize("case", REVERSAL_PERTURBATIONS)
def test_what_a_deflection_does_is_as_modelled_times_the_factor(flown, case):
    def of(name):
        return value(flown[case], name)

    # The model file's rolling moment: -0.0849 beta - 0.4042 p b/2V + 0.05552 r b/2V + 0.12019
    # aileron.
    turning = -0.4042 * of("velocities/p-aero-rad_sec") + 0.05552 * of("velocities/r-aero-rad_sec")
    rolled = of("aero/coefficient/Cl") + 0.0849 * of("aero/beta-rad") - turning * of("aero/bi2vel")
    aileron = of("fcs/aileron-pos-rad")
    assert abs(aileron) > 1e-3
    # Properties are of two neighbouring steps: a tenth of what a fifth of the effectiveness makes.
    assert rolled == pytest.approx(
        0.12019 * REVERSAL_PERTURBATIONS[case].effectiveness * aileron, rel=0.02
    )


@pytest.mark.parametrize("case", REVERSAL_PERTURBATIONS)
def test_sections_in_files_of_their_own_are_perturbed_as_those_of_the_model_file_are(
    tmp_path, case
):
    # JSBSim's Cessna has what the X8 has not: fuel, a crew of point masses.
    state = RigidBodyState(
        altitude=300.0,
        roll=0.1,
        pitch=0.05,
        velocity_body=(50.0, 0.5, 2.0),
        rates_body=(0.1, 0.1, 0.1),
    )
    moved = []
    for spec in (find_spec("c172p"), find_spec(str(split_model("c172p", tmp_path)))):
        root = tmp_path / f"copy{len(moved)}"
        perturb(copy_model(spec.files, root), REVERSAL_PERTURBATIONS[case])
        fdm = Fdm(spec, root)
        fdm.command({"elevator": -0.1, "aileron": 0.2, "rudder": 0.1, "throttle": 0.5})
        fdm.hold(state, 240)
        moved.append(
            [fdm.read("inertia/weight-lbs"), *fdm.acceleration_body(), *fdm.angular_acceleration()]
        )
    assert moved[1] == moved[0]
