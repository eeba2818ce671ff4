import numpy as np
import pytest
from plume_cases import straight

WIND, TRUE_WIND, DISTANCE = 10.0, 10.0, 200.0
COMMON = {"age_max": 30.0, "since": -40.0, "until": 400.0}


def places(sigma_y, sigma_z, height):
    across, up = np.meshgrid([-1.5, -0.7, 0.0, 0.7, 1.5], [-1.2, 0.0, 1.2])
    return across.ravel() * sigma_y, np.maximum(0.0, height + up.ravel() * sigma_z)


@pytest.mark.parametrize("structure", [0.0, 0.4])
def test_the_mean_of_realisations_is_the_regulatory_gaussian(structure):
    mean = straight(WIND, TRUE_WIND, mean=True, **COMMON)
    at = mean.sample(*np.array([[0.0], [-DISTANCE], [0.0], [50.0]]))
    across, up = places(at.sigma_y[0], at.sigma_z[0], at.axis_height[0])
    expected = mean.sample(np.zeros(15), np.full(15, -DISTANCE), across, up).dilution
    # Crossings 20 s and 200 m apart: more than twice the integral scale of the meander across.
    times = np.arange(0.0, 400.0, 20.0)
    values = []
    for seed in range(60):
        plume = straight(WIND, TRUE_WIND, seed=seed, structure_intensity=structure, **COMMON)
        time = np.repeat(times, 15)
        sample = plume.sample(
            time, WIND * time - DISTANCE, np.tile(across, len(times)), np.tile(up, len(times))
        )
        values.append(sample.dilution.reshape(len(times), 15))
    values = np.concatenate(values)
    error = values.std(axis=0) / np.sqrt(len(values))
    # 1,200 realisations: within 4 standard errors, of which 15 places are by chance in 999 of 1,000
    # tests; each is 3 to 7 % here.
    assert (np.abs(values.mean(axis=0) - expected) < 4.0 * error).all()
    assert (error / expected < 0.08).all()


def test_fluctuations_within_the_plume_have_the_intensity_asked_for():
    times = np.arange(0.0, 400.0, 5.0)
    flat, rough = [], []
    for seed in range(20):
        both = [
            straight(WIND, TRUE_WIND, seed=seed, structure_intensity=i, **COMMON)
            for i in (0.0, 0.4)
        ]
        centre = both[0].sample(
            times, WIND * times - DISTANCE, np.zeros(len(times)), np.full(len(times), 57.0)
        )
        # The plume goes south: across is to the west.
        at = (times, WIND * times - DISTANCE, -centre.centre_across, centre.centre_height)
        flat.append(both[0].sample(*at).dilution)
        rough.append(both[1].sample(*at).dilution)
    ratio = np.concatenate(rough) / np.concatenate(flat)
    # Log-normal of mean 1 and deviation 0.4, section 1.5: 1,600 values 50 m apart, and lengths of 6
    # m; three standard errors.
    assert ratio.mean() == pytest.approx(1.0, abs=0.03)
    assert ratio.std() == pytest.approx(0.4, abs=0.05)
