"""What colours mean, and whether readers who see them differently can tell them apart."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

import reports
from reports.document.palette import COLOURS, SERIES, Meaning

# Machado, Oliveira and Fernandes, A physiologically-based model for simulation of color vision
# deficiency, IEEE TVCG 15 (2009), severity 1.0, for linear RGB.
DEFICIENCIES = {
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
}


def linear(name):
    """Return linear RGB of a colour, by the transfer function of sRGB, IEC 61966-2-1."""
    channel = np.array([int(COLOURS[name][i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    return np.where(channel <= 0.04045, channel / 12.92, ((channel + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    """Return CIE L*a*b* of linear RGB, white of D65."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    ratio = to_xyz @ np.clip(rgb, 0.0, 1.0) / np.array([0.9505, 1.0, 1.089])
    f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


@pytest.mark.parametrize("deficiency", DEFICIENCIES)
def test_meanings_and_series_differ_to_eyes_without_red_or_green_cones(deficiency):
    # A difference of 10 in L*a*b* is seen at a glance; 2.3 is just noticeable (Mahy et al. 1994).
    seen = {name: lab(np.array(DEFICIENCIES[deficiency]) @ linear(name)) for name in COLOURS}
    for first, second in [*itertools.combinations(Meaning, 2), *itertools.combinations(SERIES, 2)]:
        assert np.linalg.norm(seen[first] - seen[second]) > 10.0, (first, second)


def test_limits_and_the_guard_have_their_colours_by_their_meaning_alone():
    package = Path(reports.__file__).parent
    named = [
        path.name
        for path in package.rglob("*.py")
        if re.search(r'"(vermillion|purple)"', path.read_text(encoding="utf-8"))
    ]
    assert named == ["palette.py"]
