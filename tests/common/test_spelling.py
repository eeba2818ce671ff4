"""The known name that is nearest to one that is nearly right."""

import pytest

from common.spelling import nearest


@pytest.mark.parametrize(
    ("name", "known", "found"),
    [
        # Each of these has one letter more; only one of them at its end.
        ("nu_0.5", ["nu_0.25", "nu_0.50", "nu_0.75", "nu_0.95"], "nu_0.50"),
        ("Flap", ["flap", "flaps"], "flap"),
        ("wind.speed", ["wind.speed_mps", "wind.from_deg"], "wind.speed_mps"),
        ("nothing", ["wind.speed_mps"], None),
    ],
)
def test_of_names_that_are_as_near_the_one_that_lacks_its_end_is_meant(name, known, found):
    assert nearest(name, known) == found
