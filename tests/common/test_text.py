"""Names that are nearly right, and times as text."""

from datetime import UTC, datetime

import pytest

from common.text import nearest, utc_text

NOON = datetime(2026, 6, 1, 12, tzinfo=UTC).timestamp()


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
def test_among_equally_near_names_the_one_that_only_lacks_its_end_is_meant(name, known, found):
    assert nearest(name, known) == found


@pytest.mark.parametrize(
    ("after", "text", "in_milliseconds"),
    [
        (0.0, "2026-06-01T12:00:00Z", "2026-06-01T12:00:00.000Z"),
        (0.25, "2026-06-01T12:00:00.250Z", "2026-06-01T12:00:00.250Z"),
        # Half a millisecond on either side of a second is that second.
        (0.9996, "2026-06-01T12:00:01Z", "2026-06-01T12:00:01.000Z"),
        (1.0004, "2026-06-01T12:00:01Z", "2026-06-01T12:00:01.000Z"),
    ],
)
def test_a_time_is_rounded_to_a_millisecond(after, text, in_milliseconds):
    assert utc_text(NOON + after) == text
    assert utc_text(NOON + after, milliseconds=True) == in_milliseconds
