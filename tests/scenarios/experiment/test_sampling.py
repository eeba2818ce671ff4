import numpy as np
import pytest
from scipy.stats import qmc

from scenarios.experiment.sampling import SamplingDesign


def points(sampling, count, **changes):
    values = {"dimension": 5, "flights": 1024, "seed": 3} | changes
    made = SamplingDesign(sampling, **values)
    return np.array([made.at(number) for number in range(count)])


@pytest.mark.parametrize("sampling", ["sobol", "latin_hypercube"])
def test_a_point_depends_on_its_number_and_the_studys_seed_alone(sampling):
    whole = points(sampling, 600)
    # Asked for one by one and backwards, as tasks come from processes in any order.
    other = SamplingDesign(sampling, dimension=5, flights=1024, seed=3)
    assert [other.at(number) for number in (599, 3, 256, 255)] == [
        tuple(whole[number]) for number in (599, 3, 256, 255)
    ]
    assert not np.array_equal(whole, points(sampling, 600, seed=4))


def test_a_sobol_sequence_is_that_of_scipy_whatever_blocks_it_is_made_in():
    assert np.array_equal(points("sobol", 1024), qmc.Sobol(5, scramble=True, rng=3).random(1024))


def test_a_latin_hypercube_has_one_flight_in_each_stratum_of_each_input():
    strata = np.floor(1024 * points("latin_hypercube", 1024)).astype(int)
    for column in strata.T:
        assert sorted(column) == list(range(1024))


def test_a_sobol_sequence_spreads_more_evenly_than_chance():
    # Discrepancy of 512 points in 5 dimensions: 9e-4 at random by expectation, (5/4)^5 -
    # (13/12)^5... of a scrambled net far below.
    random = np.random.default_rng(0).random((512, 5))
    assert qmc.discrepancy(points("sobol", 512)) < 0.2 * qmc.discrepancy(random)
