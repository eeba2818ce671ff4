"""Times as text."""

from datetime import UTC, datetime

import pytest

from common.times import utc_text

NOON = datetime(2026, 6, 1, 12, tzinfo=UTC).timestamp()


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
