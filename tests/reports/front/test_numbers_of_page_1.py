"""Every number on page 1, as printed, is that of the summary and of the verdict of its run.

What each kind of study is to say is put together here from the rows of its flights, and taken out of
the text of the page: no digit may be left.
"""

import math
import re
from dataclasses import replace

import pypdfium2
import pytest
from judged_runs import judged
from matplotlib.figure import Figure
from report_parts import flown_text
from scipy.stats import beta

from common.verdict import read_verdict
from reports.output import write_report
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

SULPHUR = """
extends = "sulphur"
fidelity = "kinematic"
guidance.rate_hz = 10.0
flight.after_settling_s = 60.0
"""

SETTLING_BAND_M = 5.0
"""Default of flight.settling_band_m: what a flight that settled has not lost again."""

FIXED = (
    r"\d{4}-\d\d-\d\d \d\d:\d\d UTC",
    r"a merchant ship of 150 m by 23 m",
    r"that of a container feeder, 160 m by 25 m",
    r"page 1 of \d+",
    r"Figure 1",
    r"eq\. \(1\)",
    r"short_0000\d",
    r"(SO2|CO2|NO2)",
)
"""What has digits and is no figure: dates, names, and what the scenario gives."""


@pytest.fixture
def five(five_path):
    return read_run(five_path)


@pytest.fixture(scope="module")
def sulphur(tmp_path_factory):
    return read_run(flown_text(tmp_path_factory, "short", SULPHUR))


@pytest.fixture
def page_1(tmp_path, monkeypatch):
    """Return what reads page 1 of the report of a run."""
    monkeypatch.setattr("reports.render.figure_files.draw", lambda _: Figure(figsize=(1.0, 1.0)))

    def read(run):
        write_report(run, tmp_path / "report.pdf")
        document = pypdfium2.PdfDocument(tmp_path / "report.pdf")
        text = document[0].get_textpage().get_text_range()
        document.close()
        return " ".join(text.replace("\N{NO-BREAK SPACE}", " ").split())

    return read


def assert_says_no_more(text, claims):
    """Take what is claimed out of a page, the longest first, and find no digit in what is left."""
    whole = text
    for claim in sorted(claims, key=len, reverse=True):
        # Not the end of another number.
        words = rf"(?<![\d.]){re.escape(claim)}"
        assert re.search(words, whole), (claim, whole)
        text = re.sub(words, " ", text)
    for words in FIXED:
        text = re.sub(words, " ", text)
    assert not re.search(r"\d", text), text


def short(value, limit=None):
    """Return a figure to three digits, without what is less than a thousandth of its limit."""
    if limit:
        value = round(value, 3 - math.floor(math.log10(limit)))
    return f"{float(f'{value:.3g}'):g}"


def flown_words(rows, vessel):
    flights, hours = len(rows), rows["duration_s"].sum() / 3600.0
    time = f"{3600.0 * hours:.0f} s" if 60.0 * hours < 2.0 else f"{60.0 * hours:.2g} min"
    return [
        f"{flights} flight{'s' * (flights > 1)} ({time} simulated)",
        f"beside a vessel at {vessel} m/s",
    ]


LIMITS = {
    "interval": (1.0, "%"),
    "tracking": (5.0, "m"),
    "airspeed": (0.3, "m/s"),
    "altitude": (1.5, "m"),
}
"""Of the criteria of the short scenario: the limit, and the unit."""


def figures(rows):
    """Return the figures of each flight that criteria limit."""
    ratio = rows["crossing_interval_mean_s"] / rows["crossing_interval_predicted_s"]
    return {
        "interval": 100.0 * (ratio - 1.0).abs(),
        "tracking": rows["tracking_error_rms_m"],
        "airspeed": rows["airspeed_error_rms_mps"],
        "altitude": rows["altitude_error_max_m"],
    }


def worst(rows):
    """Return the worst of each figure as printed, with its unit."""
    return {
        name: f"{short(of.max(), LIMITS[name][0])} {LIMITS[name][1]}"
        for name, of in figures(rows).items()
    }


def nearest(rows):
    """Return how near the flights came, as printed, from the centre and from the keep-out area."""
    row = rows.loc[rows["min_distance_m"].idxmin()]
    return [f"{row['min_distance_m'] - r:.1f} m" for r in (0.0, row["keepout_radius_m"])]


def tiles(rows, several=True):
    """Return what the tiles of flights say that all met their criteria."""
    shown = worst(rows)
    flights = len(rows)
    required = [f"required ≤ {limit:g} {unit}" for limit, unit in LIMITS.values()]
    counts = [
        "Kept out Finished",
        f"{flights} of {flights} {flights} of {flights} {nearest(rows)[0]}",
    ]
    named = list(LIMITS)[: 3 if several else 4]
    return [
        *(counts if several else []),
        nearest(rows)[0],
        "required ≥ 200 m",
        *(shown[name] for name in named),
        *required[: len(named)],
    ]


def percent(share):
    return f"{short(100.0 * share)} %"


def pearson(events, flights):
    """Return the two-sided interval of Clopper and Pearson at 95 %."""
    low = beta.ppf(0.025, events, flights - events + 1) if events else 0.0
    high = beta.ppf(0.975, events + 1, flights - events) if events < flights else 1.0
    return low, high


def rate_below(rows):
    """Return the one-sided bound where none of some flights violated: (1 - p)^n = 5 %."""
    return f"rate of violations below {percent(1.0 - 0.05 ** (1.0 / len(rows)))} at 95 %"


def of_many(rows):
    shown, flights = worst(rows), len(rows)
    return (
        f"{flights} of {flights} flights kept out, {flights} finished. Worst: {nearest(rows)[1]} beyond"
        f" r_min, interval {shown['interval']} off, tracking {shown['tracking']}, airspeed"
        f" {shown['airspeed']}, altitude {shown['altitude']}"
    )


def probabilities(rows):
    low, high = pearson(0, len(rows))
    one = f"{percent(0.0)} ({short(100.0 * low)} to {percent(high)})"
    return (
        f"Probability of violation {one}, of loss {one}, of not finishing {one}, at 95 % confidence"
    )


def nearest_found(rows):
    row = rows.loc[rows["min_distance_m"].idxmin()]
    return (
        f"Nearest of {len(rows)} flights: {nearest(rows)[1]} beyond r_min, {row['flight_id']} (fault"
        f" {row['fault']}, wind {row['wind_speed_mps']:.1f} m/s); 0 violated, 0 lost, 0 diverged, 0 unknown"
    )


def exceeded(rows):
    return int((~rows["premises_exceeded"].fillna("").isin(["", "none"])).sum())


def premises_exceeded(rows):
    return (
        f"In {exceeded(rows)} of {len(rows)} flights an error exceeded what the guard reckons with; 0 violated"
        " the area, 0 of them with every premise held"
    )


@pytest.mark.parametrize(
    ("study", "answer"),
    [
        ("flights", of_many),
        ("monte_carlo", probabilities),
        ("falsify", nearest_found),
        ("premises", premises_exceeded),
    ],
)
def test_flights_of_each_study_say_what_their_rows_say(five, page_1, study, answer):
    rows, text = five.summary, page_1(replace(five, manifest=five.manifest | {"study": study}))
    claims = [*flown_words(rows, "8"), *tiles(rows), answer(rows), rate_below(rows)]
    assert_says_no_more(text, claims)


def test_an_interrupted_run_says_so_first_and_how_many_flights_were_flown(five, page_1):
    manifest = five.manifest | {"flights_planned": 9, "trial_flights": {"short": 9}}
    rows, run = five.summary, judged(replace(five, manifest=manifest), interrupted=True)
    text = page_1(run)
    assert "! INTERRUPTED after 5 of 9 flights. 5 of 5" in text
    claims = ["INTERRUPTED after 5 of 9 flights", "Short: 4 of 9 not flown yet"]
    claims += [*flown_words(rows, "8"), *tiles(rows), of_many(rows), rate_below(rows)]
    assert_says_no_more(text, claims)


def test_a_flight_alone_says_what_its_row_says(one_path, page_1):
    one = read_run(one_path)
    rows, text = one.summary, page_1(one)
    criteria = [of for of in read_verdict(one.path / "verdict.json").whole.criteria if of.judged]
    met = sum(of.failed == 0 for of in criteria)
    claims = [
        f"it met {met} of the {len(criteria)} criteria",
        f"{exceeded(rows)} of 1",
        *flown_words(rows, "8"),
        *tiles(rows, several=False),
    ]
    assert_says_no_more(text, claims)


def test_a_sweep_says_whether_it_crossed_as_often_as_predicted(sweep_path, page_1):
    sweep = read_run(sweep_path)
    rows, text = sweep.summary, page_1(sweep)
    off = worst(rows)["interval"]
    claims = [
        "2 of 2 speed ratios kept out, 2 finished. Crossing intervals are up to"
        f" {off} off the prediction, limit 1 %",
        *flown_words(rows, " to ".join(f"{round(v, 1):g}" for v in rows["vessel_speed_mps"])),
        *tiles(rows),
    ]
    # Of each worst figure the flight is named.
    claims += [f"ν = {nu}" for nu in ("0.20", "0.40") if f"ν = {nu}" in text]
    assert_says_no_more(text, claims)


def test_a_flight_with_a_sniffer_says_what_it_measured(sulphur, page_1):
    rows, text = sulphur.summary, page_1(sulphur)
    row = rows.iloc[0]
    content, low, high = (f"{row[f'fsc_{name}percent']:.3f}" for name in ("", "low_", "high_"))
    chance = f"{100.0 * row['probability_above']:.1f} %"
    limit = f"{row['sulphur_limit_percent']:.2f} %"
    off = figures(rows)
    claims = [
        f"fuel sulphur {content} % ({low} to {high}), limit {limit}; {chance} chance of being above",
        f"Probability above the limit of {limit}",
        f"below the limit of {limit}",
        f"{content} % m/m {chance}",
        f"95 % interval {low} to {high} %",
        *(
            f"{short(off[name].max())} {LIMITS[name][1]}"
            for name in ("interval", "tracking", "airspeed")
        ),
        "a heading-rate lag of 0.4 s",
        f"wind of {row['wind_speed_mps']:g} m/s",
        *flown_words(rows, f"{row['vessel_speed_mps']:g}"),
        nearest(rows)[0],
        "required ≥ 200 m",
    ]
    if row["tracking_error_rms_m"] > SETTLING_BAND_M:
        claims.append(f"lost its track again, by {row['tracking_error_rms_m']:.3g} m rms")
    if isinstance(row["sulphur_reason"], str):
        claims.append(f"quality {row['sulphur_quality']}: {row['sulphur_reason']}")
    assert_says_no_more(text, claims)
