"""Files, pictures, columns, names and intervals."""

import io
import json
import math
from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from scipy.stats import binom

from common.columns import Column, described, from_json, to_json
from common.files import json_text
from common.intervals import clopper_pearson, quantile_interval, upper_bound
from common.picture import PictureError, read_picture
from common.text import nearest, utc_text


def test_numbers_of_numpys_are_written_as_numbers():
    # A shape or a plume of a user's own may answer in them.
    numbers = {"speed": np.float32(0.5), "count": np.int64(3)}
    text = json_text(numbers | {"whole": np.bool_(True), "array": np.array(1.5)}, indent=1)
    assert json.loads(text) == {"speed": 0.5, "count": 3, "whole": True, "array": 1.5}


def test_what_json_cannot_express_is_an_error():
    with pytest.raises(ValueError, match="JSON compliant"):
        json_text({"speed": np.float32(np.nan)}, indent=1)
    with pytest.raises(TypeError, match="JSON cannot express set"):
        json_text({"speed": {1.0}}, indent=1)


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


SVG = (
    b'<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2">'
    b'<rect width="4" height="2"/></svg>'
)


def drawn(kind):
    buffer = io.BytesIO()
    Image.new("RGB", (40, 20), "navy").save(buffer, kind)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("content", "media_type", "suffix"),
    [
        (drawn("PNG"), "image/png", ".png"),
        (drawn("JPEG"), "image/jpeg", ".jpg"),
        (SVG, "image/svg+xml", ".svg"),
    ],
)
def test_the_content_says_what_kind_of_picture_a_file_is_and_its_name_does_not(
    content, media_type, suffix, tmp_path
):
    path = tmp_path / "logo.dat"
    path.write_bytes(content)
    picture = read_picture(path)
    assert (picture.content, picture.media_type, picture.suffix) == (content, media_type, suffix)


LINKED = SVG.replace(b"<rect", b'<image href="https://example.org/a.png"/><rect')
ENCODED = b'<?xml version="1.0" encoding="none-such"?>' + SVG


@pytest.mark.parametrize("content", [b"", drawn("PNG")[:60], b"<html/>", ENCODED, LINKED])
def test_what_is_no_picture_is_refused_in_one_line_that_names_the_file_alone(content, tmp_path):
    path = tmp_path / "logo.png"
    path.write_bytes(content)
    with pytest.raises(PictureError) as refused:
        read_picture(path)
    assert str(refused.value).startswith("'logo.png' is not a picture")
    assert "\n" not in str(refused.value)


WORDS = st.text(st.characters(categories=("L", "N")), min_size=1, max_size=12)
COLUMNS = st.builds(
    Column,
    WORDS,
    title=WORDS,
    symbol=WORDS | st.just(""),
    unit=WORDS,
    digits=st.integers(0, 12),
    worse=st.sampled_from(["", "higher", "lower", "off zero"]),
    adds_up=st.booleans(),
    kind=st.sampled_from(["number", "text", "truth", "any"]),
    part=WORDS | st.just(""),
)


@given(st.dictionaries(WORDS, st.dictionaries(WORDS, COLUMNS, max_size=3), max_size=3))
def test_tables_come_back_from_their_file_as_they_were_declared(tables):
    declared = {name: described(columns) for name, columns in tables.items()}
    assert from_json(json.loads(json.dumps(to_json(declared)))) == declared


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"digits": 1.5}, "digits of a column is 1.5; give 0 to 12"),
        ({"digits": True}, "digits of a column is True"),
        ({"worse": "bigger"}, "worse of a column is 'bigger'; give one of '', 'higher'"),
        ({"unit": 3}, "unit of a column is 3; give text of one line"),
        ({"title": "a\nb"}, "give text of one line"),
        ({"scale": 0.0}, "scale of a column is 0.0"),
        ({"scale": float("nan")}, "scale of a column is nan"),
        ({"kind": []}, "kind of a column is []"),
    ],
)
def test_what_is_no_column_is_refused_in_one_line(given, words):
    with pytest.raises(ValueError, match="of a column is") as refused:
        Column(**given)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_no_event_in_ten_thousand_bounds_the_probability_by_the_root_of_what_confidence_leaves():
    # Without any event (1 - p)^n = 0.05 at the bound.
    assert upper_bound(0, 10_000, 0.95) == pytest.approx(1.0 - 0.05 ** (1.0 / 10_000), rel=1e-12)
    # The rule of three, 3/n, is that of J. A. Hanley and A. Lippman-Hand, JAMA 249 (1983);
    # -ln(0.05) is 2.9957.
    assert upper_bound(0, 10_000, 0.95) == pytest.approx(2.9957e-4, rel=2e-4)


def test_the_exact_interval_of_ten_in_a_hundred_is_the_one_that_r_gives():
    # binom.test(10, 100) of R: 0.04900469 0.17622260, to all the digits it prints.
    interval = clopper_pearson(10, 100, 0.95)
    assert (interval.low, interval.high) == pytest.approx((0.04900469, 0.17622260), abs=5e-9)


@pytest.mark.parametrize(("events", "trials"), [(1, 30), (7, 30), (29, 30), (3, 5000)])
def test_at_each_end_what_was_seen_or_worse_has_half_of_what_confidence_leaves(events, trials):
    interval = clopper_pearson(events, trials, 0.9)
    # The definition of Clopper and Pearson; a beta quantile is good to a few units of the eleventh
    # digit.
    assert binom.cdf(events, trials, interval.high) == pytest.approx(0.05, rel=1e-9)
    assert binom.sf(events - 1, trials, interval.low) == pytest.approx(0.05, rel=1e-9)


def test_the_largest_of_59_bounds_the_95th_percentile_and_the_largest_of_58_does_not():
    # S. S. Wilks, Annals of Mathematical Statistics 12 (1941): 59 values for 95 % of the population
    # at 95 %. Two-sided 90 % has that confidence on each side.
    assert quantile_interval(np.arange(59.0), 0.95, 0.9).high == 58.0
    assert math.isnan(quantile_interval(np.arange(58.0), 0.95, 0.9).high)
    assert math.isnan(quantile_interval(np.arange(58.0), 0.95, 0.9).width)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: upper_bound(3, 2, 0.95), "events are 3 of 2 trials; there can be 0 to 2"),
        (lambda: clopper_pearson(1, 2, 1.0), "must be between 0 and 1, such as 0.95"),
        (lambda: quantile_interval(np.ones(3), 1.0, 0.95), "probability is 1; quantiles are of"),
    ],
)
def test_what_cannot_be_is_refused_with_its_value_and_limit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
