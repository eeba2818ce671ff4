"""Aircraft whose mass, inertia or controls' effectiveness are not as modelled."""

import pytest

from aircraft.fleet.x8 import X8
from innerloop.flight.turn_reversal import REVERSAL_PERTURBATIONS, perturbed_aircraft


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
