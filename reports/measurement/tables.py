"""Tables of a measured fuel sulphur content."""

from typing import Any

from measurement.gases import MASS_PERCENT
from measurement.log.analysis import Gaps
from reports.document.blocks import Table
from reports.document.tables import number, pairs_table
from reports.measurement.data import METHODS, Record

_PERCENT = "{:.3f}"


def result_table(record: Record) -> Table:
    """Return the result by each method."""
    rows = []
    for found in (record["estimate"], record.get("other")):
        if found is None:
            continue
        rows.append([
            METHODS[found["method"]],
            number(found["fsc_percent"], _PERCENT),
            number(found["noise_percent"], _PERCENT),
            number(found["total_percent"], _PERCENT),
            f"{number(found['low_percent'], '{:.3f}')} to"
            f" {number(found['high_percent'], _PERCENT)}",
            found["quality"],
        ])  # fmt: skip
    head = [
        "Method", f"Sulphur content [{MASS_PERCENT}]", f"Noise, 1σ [{MASS_PERCENT}]",
        f"Standard uncertainty, 1σ [{MASS_PERCENT}]",
        f"95 % interval [{MASS_PERCENT}]", "Quality",
    ]  # fmt: skip
    caption = (
        "The result by each method. Interval and probabilities come from a normal distribution of"
        " content and standard uncertainty, cut off at 0. An interval that starts at 0 is a"
        " one-sided 95 % limit."
    )
    other = record.get("other")
    if other is not None and other["quality"] == "C":
        caption += (
            f" Why {METHODS[other['method']]} have quality C:"
            f" {'; '.join(other['quality_reasons'])}."
        )
    return Table(caption=caption, head=head, rows=rows, widths=[1.8, 1.2, 0.8, 1.9, 1.5, 0.7])


def record_table(record: Record) -> Table:
    """Return what the record holds, and the response of SO2 as it was taken."""
    found, figures = record["estimate"], record["estimate"]["figures"]
    t90 = (
        f"{number(found['so2_t90_s'], '{:.1f}')} ± {number(found['so2_t90_sd_s'], '{:.1f} s')} (1σ)"
    )
    delay = f"{number(found['delay_s'], '{:.2f}')} ± {number(found['delay_sd_s'], '{:.2f} s')} (1σ)"
    dose, agreement = (
        number(figures["dose_ppm_s"], "{:.0f} ppm s"),
        number(found["agreement"], "{:.2g}"),
    )
    gaps = Gaps(**record["gaps"])
    rows = [
        ["Missing readings", gaps.missing_words],
        ["Gaps", gaps.gap_words],
        [
            "Passes",
            f"{figures['passes']}, every {number(figures['interval_s'], '{:.1f} s')}; agreement p"
            f" = {agreement}",
        ],
        [
            "In the plume",
            f"{figures['seconds_in_plume']:.0f} s of {figures['duration_s']:.0f} s; CO2 dose of a"
            f" pass {dose}",
        ],
        [
            "Signal to noise",
            f"CO2 peaks {number(figures['co2_snr'], '{:.0f}')}, SO2"
            f" {number(figures['so2_snr'], '{:.1f}')}",
        ],
        ["Background", _background_words(figures)],
        ["Passes of another fuel", _excluded_words(found["excluded"])],
        ["Residuals over stated noise", number(found["misfit"], "{:.1f} (mean square)")],
        ["SO2 channel", f"t90 {t90}; {delay} after CO2"],
        [
            "Sulphate, not corrected",
            f"{number(found['sulphate_percent'], '{:.4f} %')}: sulphur that does not leave as SO2",
        ],
    ]
    return pairs_table(
        rows,
        widths=(1.0, 3.0),
        caption="What the record holds, and the response of SO2 as it was taken.",
    )


def _background_words(figures: dict[str, Any]) -> str:
    """Return how much the background varies, and within which time."""
    co2 = number(figures["background_ppm"], "{:.2f} ppm")
    length = number(figures["background_s"], "{:.0f} s")
    rest = number(figures["background_ppb"], "{:.2f} ppb")
    return (
        f"CO2 varies by {co2} (1σ) with a correlation length of {length}; SO2 beside the plume by"
        f" {rest}"
    )


def _excluded_words(excluded: list[dict[str, float]]) -> str:
    """Return the contents of the passes that were left out, with their times."""
    words = [
        f"{item['fsc_percent']:.2f} ± {item['noise_percent']:.2f} % at {item['time_s']:.0f} s"
        for item in excluded
    ]
    return ", ".join(words) or "none"
