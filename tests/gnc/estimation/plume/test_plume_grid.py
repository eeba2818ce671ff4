"""The cells of the plume estimate: what a pass is expected to read in each."""

from dataclasses import replace

import numpy as np
import pytest
from exhaust_cases import PRIOR

from gnc.estimation.plume.estimator import STRENGTH_STEP, PlumeGrid, random_walk

GRID = PlumeGrid(PRIOR)

MIDDLE = len(GRID.sigma_z) // 2
"""The expected spread."""

SPREAD = GRID.coarse_heights(GRID.sigma_z[MIDDLE])


def test_the_prior_has_the_moments_that_it_was_given() -> None:
    assert GRID.prior.sum() == pytest.approx(1.0)
    of_heights = GRID.prior.sum(axis=(0, 2))
    # Cut at three deviations, a Gaussian keeps 98.7 % of its deviation, and a funnel in a range has
    # shorter tails.
    assert of_heights @ GRID.height == pytest.approx(PRIOR.height, abs=0.1)
    deviation = np.sqrt(of_heights @ (GRID.height - PRIOR.height) ** 2)
    assert 0.97 * PRIOR.height_deviation < deviation < 1.001 * PRIOR.height_deviation
    assert GRID.bearing_prior.sum() == pytest.approx(1.0)
    # The sum over steps of a quarter of a deviation is the integral; cut at three, a Gaussian keeps
    # 98.7 %.
    assert np.sqrt(GRID.bearing_prior @ GRID.bearing**2) == pytest.approx(
        0.987 * PRIOR.bearing_deviation, rel=0.005
    )


def test_a_funnel_whose_height_has_a_range_is_as_likely_anywhere_in_it() -> None:
    grid = PlumeGrid(replace(PRIOR, height_deviation=12.0, source_deviation=11.9))
    of_heights = grid.prior.sum(axis=(0, 2))
    # A range of 2 sqrt(3) 11.9 m, of which the rise of 1.5 m blurs the ends.
    inside = np.abs(grid.height - PRIOR.height) < 15.0
    assert of_heights[inside] == pytest.approx(of_heights[inside].mean(), rel=0.01)
    assert of_heights[np.abs(grid.height - PRIOR.height) > 26.0].sum() < 1e-3


def test_a_funnel_whose_height_is_known_leaves_the_rise_alone() -> None:
    # As likely as a normal distribution of the rise's 4 m, cut at three deviations.
    grid = PlumeGrid(replace(PRIOR, height_deviation=4.0, source_deviation=0.0))
    of_heights = grid.prior.sum(axis=(0, 2))
    assert np.sqrt(of_heights @ (grid.height - PRIOR.height) ** 2) == pytest.approx(
        0.987 * 4.0, rel=0.005
    )


@pytest.mark.parametrize("looks", [1, 3])
def test_fading_is_that_of_centres_drawn_at_random(looks: int) -> None:
    altitude, i = 70.0, len(GRID.height) // 2
    fading = GRID.fading(GRID.height - altitude, looks)[MIDDLE, i]
    centres = GRID.height[i] + PRIOR.meander_z * np.random.default_rng(1).standard_normal(
        (looks, 200_000)
    )
    off = np.abs(centres - altitude).min(axis=0)
    steps = np.rint(0.5 * (off / GRID.sigma_z[MIDDLE, i]) ** 2 / STRENGTH_STEP).astype(int)
    drawn = np.bincount(steps, minlength=len(fading))[: len(fading)] / 200_000
    # A share p of 200,000 has a deviation of at most 0.0011.
    assert fading == pytest.approx(drawn, abs=0.005)


def test_a_plume_far_from_the_pass_is_not_read() -> None:
    fading = GRID.fading(GRID.height - 300.0, 1.0)
    assert fading.sum() < 1e-9


def test_chances_rise_with_strength_and_fall_with_the_distance() -> None:
    off = (GRID.coarse_heights(GRID.height) - 65.0)[np.newaxis]
    chances = GRID.chances(off, 1.0, 4.0, SPREAD)[0]
    assert np.all(np.diff(chances, axis=1) >= -1e-12)
    above = int(np.argmax(off[0] >= 0.0))
    assert np.all(np.diff(chances[above:], axis=0) <= 1e-12)


def test_heights_taken_together_have_the_mean_of_the_cells() -> None:
    """What the next height is chosen by is where the estimate is, not half a cell below."""
    weights, heights = GRID.coarse(GRID.prior).sum(axis=1), GRID.coarse_heights(GRID.height)
    assert weights.sum() == pytest.approx(1.0)
    of_heights = GRID.prior.sum(axis=(0, 2))
    # Two cells count by the mean of their heights: within a pair of 2 m they differ by a few per
    # cent.
    assert weights @ heights == pytest.approx(of_heights @ GRID.height, abs=0.02)
    one = np.zeros_like(GRID.prior)
    one[MIDDLE, -1, 0] = 1.0
    assert GRID.coarse(one).sum(axis=1) @ heights == GRID.height[-1]


@pytest.mark.parametrize("steps", [0.0, 0.1, 0.5, 0.7, 10.0])
def test_a_random_walk_has_the_variance_that_it_should_and_loses_nothing(steps: float) -> None:
    cells = np.zeros((3, 201))
    cells[:, 100] = [0.2, 0.3, 0.5]
    found = random_walk(cells, 1, steps)
    assert found.sum(axis=1) == pytest.approx(cells.sum(axis=1), rel=1e-12)
    assert found.min() >= 0.0
    off = np.arange(201) - 100
    # Exact: each round moves a share by one step either way. At ten deviations from the ends,
    # rounding is left.
    assert found[2] @ off**2 / found[2].sum() == pytest.approx(steps, abs=1e-12)


def test_a_pass_is_never_expected_to_widen_the_height() -> None:
    """The law of total variance."""
    weights, heights = GRID.coarse(GRID.prior), GRID.coarse_heights(GRID.height)
    altitudes = np.array([-500.0, 40.0, 65.0, 90.0, 500.0])
    expected = GRID.expected_deviation(
        weights, heights, heights - altitudes[:, np.newaxis], 1.0, SPREAD
    )
    of_heights = weights.sum(axis=1)
    now = float(np.sqrt(of_heights @ heights**2 - (of_heights @ heights) ** 2))
    assert np.all(expected <= now + 1e-9)
    # A pass far away says nothing, one within the plume does.
    assert expected[[0, -1]] == pytest.approx(now, rel=1e-6)
    assert expected[1:4].max() < 0.95 * now


def test_a_plume_that_rises_more_is_wider_and_weaker() -> None:
    assert np.all(np.diff(GRID.sigma_z[MIDDLE]) >= 0.0)
    peaks = GRID.prior[MIDDLE] @ np.log(GRID.strength) / GRID.prior[MIDDLE].sum(axis=1)
    assert peaks[-1] < peaks[0]


def test_without_an_uncertain_stack_the_whole_difference_is_rise() -> None:
    sure = replace(PRIOR, source_deviation=0.0)
    assert sure.rise_of(90.0) == pytest.approx(90.0 - PRIOR.source_height)
    assert replace(PRIOR, source_deviation=PRIOR.height_deviation).rise_of(90.0) == pytest.approx(
        25.0
    )


def test_what_a_pass_is_expected_to_read_adds_up_to_its_chance_of_anything() -> None:
    fading = GRID.fading(GRID.height - 70.0, 1.5)
    read = GRID.reading_probability(GRID.prior, fading)
    # By spread, height and step; what a pass misses is the rest to 1.
    assert read.sum() == pytest.approx(
        float((GRID.prior.sum(axis=2)[..., np.newaxis] * fading).sum()), rel=1e-12
    )
    # Against the definition: each strength, fainter by each step.
    one = np.zeros_like(GRID.prior)
    one[MIDDLE, 20, 5] = 1.0
    expected = np.zeros(len(GRID.faint))
    nearest = [
        int(np.abs(np.log(GRID.faint / GRID.strength[5]) + STRENGTH_STEP * step).argmin())
        for step in range(fading.shape[2])
    ]
    expected[nearest] = fading[MIDDLE, 20]
    assert GRID.reading_probability(one, fading)[MIDDLE] == pytest.approx(expected)


def test_a_pass_looks_as_wide_as_its_plume_or_less_likely_otherwise() -> None:
    of_widths = GRID.width_likelihood(0.2)
    assert of_widths.sum(axis=1) == pytest.approx(1.0)
    beside = (of_widths.shape[1] - len(of_widths)) // 2
    assert of_widths.argmax(axis=1).tolist() == [beside + w for w in range(len(of_widths))]
    assert GRID.widths[beside : -beside or None] == pytest.approx(
        PRIOR.sigma_y * GRID.sigma_y[:, 22] / GRID.sigma_y[MIDDLE, 22]
    )
