"""The instrument of a logged flight, how its log was read, and what the analysis assumed."""

from collections.abc import Callable, Sequence
from typing import Any

from common.intervals import percent
from measurement.estimate.budget import CARBON_SD, SULPHATE_SHARE
from measurement.estimate.passes import SNR_LEAST
from measurement.estimate.quality import AGREEMENT_LEAST, PASSES_GOOD, SNR_GOOD, UNCERTAINTY_GOOD
from measurement.estimate.verdict import (
    CONFIDENCE,
    COVERAGE,
    GUARD,
    Decision,
    Verdict,
    decision_words,
    from_record,
    rate_words,
)
from measurement.gases import EXPECTED_PPB_PER_PPM, GASES, UNITS, fsc_factor, limit_words
from reports.document.blocks import Table
from reports.document.tables import number, pairs_table
from reports.measurement.data import METHODS, Record
from reports.run.run_data import RunData

_Channel = dict[str, Any]

_FOUND = "from the record"


def instrument_table(record: Record) -> Table:
    """Return every property of the instrument, a column per channel."""
    instrument, columns, given = (
        record["instrument"],
        record["flight"]["columns"],
        record["flight"]["stated"],
    )
    stated, used = instrument["stated"], instrument["used"]
    gases = [gas for gas in GASES if gas in stated]

    def row(name: str, cell: Callable[[_Channel, _Channel], str], *keys: str) -> list[str]:
        return [
            name,
            *(_marked(cell(stated[gas], used[gas]), keys, given and given[gas]) for gas in gases),
        ]

    others = [
        other
        for other in GASES
        if any(other in stated[gas]["cross"] | stated[gas]["cross_sd"] for gas in gases)
    ]
    rows = [
        ["Column of the log", *(columns.get(gas, "none: not measured") for gas in gases)],
        row("Response time t90 ± 1σ [s]", _t90(record["estimate"]), "t90_s", "t90_sd"),
        row(
            "Second time constant over the first [-]",
            lambda of, _: _plain(of["second_pole"]),
            "second_pole",
        ),
        row("Delay ± 1σ [s]", _delay(record["estimate"]), "delay_s", "delay_sd_s"),
        row("Noise of a reading, 1σ", _noise, "noise"),
        row(
            "Drift of the zero after 1 s, 1σ",
            lambda of, _: _plain(of["random_walk"]),
            "random_walk",
        ),
        row("Resolution", lambda of, _: _plain(of["resolution"]), "resolution"),
        row("Range", _range, "range_high", "range_low"),
        row(
            "Calibration: gain ± 1σ [-]",
            lambda of, _: _with_deviation(of["gain"], of["gain_sd"]),
            "gain",
            "gain_sd",
        ),
        row(
            "Calibration: zero ± 1σ",
            lambda of, _: _with_deviation(of["zero"], of["zero_sd"]),
            "zero",
            "zero_sd",
        ),
        *(
            row(
                f"Response to {gas.upper()} ± 1σ [per {UNITS[gas]}]",
                _response(gas),
                "cross",
                "cross_sd",
            )
            for gas in others
        ),
        row(
            "Effect of pressure, not corrected [1/hPa]",
            lambda of, _: _plain(of["pressure_effect"]),
            "pressure_effect",
        ),
    ]
    estimated = (
        f" “{_FOUND.capitalize()}”: not stated, and estimated; its 1σ is without what lies"
        " between readings."
    )
    found = estimated if any(_FOUND in cell for row in rows for cell in row) else ""
    return Table(
        caption=(
            f"The channels as the analysis used them.{found} What has no unit is in that of"
            f" its column. Instrument: {instrument['title']}."
        ),
        head=["Property", *(f"{gas.upper()} [{UNITS[gas]}]" for gas in gases)],
        rows=rows,
        widths=[2.2, *(1.0 for _ in gases)],
    )


def _marked(cell: str, keys: Sequence[str], given: Sequence[str] | None) -> str:
    """Return a cell with a word on what the configuration does not state of it; of a preset its
    source says that.

    Parameters
    ----------
    cell : what is shown
    keys : of the value and, where it has one, its deviation
    given : those that the configuration has, or None of a preset
    """
    if given is None or cell in ("none", "not stated") or _FOUND in cell or keys[-1] in given:
        return cell
    return f"{cell}, 1σ assumed" if keys[0] in given else f"{cell}, assumed"


def _plain(value: float | None) -> str:
    return "none" if value == 0.0 else number(value, "{:g}")


def _with_deviation(value: float, deviation: float) -> str:
    return (
        f"{number(value, '{:g}')} ± {number(deviation, '{:g}')}"
        if deviation
        else f"{number(value, '{:g}')}, exact"
    )


def _t90(found: Record) -> Callable[[_Channel, _Channel], str]:
    """Return what writes a response time; SO2 alone may have one that is not stated."""

    def cell(stated: _Channel, _: _Channel) -> str:
        if stated["t90_sd"] is None:
            return (
                f"{number(found['so2_t90_s'], '{:.1f}')} ±"
                f" {number(found['so2_t90_sd_s'], '{:.1f}')}, {_FOUND}"
            )
        return _with_deviation(stated["t90_s"], stated["t90_s"] * stated["t90_sd"])

    return cell


def _delay(found: Record) -> Callable[[_Channel, _Channel], str]:
    """Return what writes a delay; SO2 alone may have one that is not stated, which then is that
    after CO2.
    """

    def cell(stated: _Channel, _: _Channel) -> str:
        if stated["delay_sd_s"] is None:
            return (
                f"{number(found['delay_s'], '{:.2f}')} ± {number(found['delay_sd_s'], '{:.2f}')}"
                f" after CO2, {_FOUND}"
            )
        return _with_deviation(stated["delay_s"], stated["delay_sd_s"])

    return cell


def _noise(stated: _Channel, used: _Channel) -> str:
    if stated["noise"] is None:
        return (
            f"{number(used['noise'], '{:.2g}')}, {_FOUND}"
            if used["noise"] is not None
            else "not stated"
        )
    return number(stated["noise"], "{:g}")


def _range(stated: _Channel, _: _Channel) -> str:
    low, high = stated["range_low"], stated["range_high"]
    if low is None and high is None:
        return "not stated"
    return " to ".join("no limit" if end is None else number(end, "{:g}") for end in (low, high))


def _response(gas: str) -> Callable[[_Channel, _Channel], str]:
    def cell(stated: _Channel, _: _Channel) -> str:
        share, deviation = stated["cross"].get(gas, 0.0), stated["cross_sd"].get(gas, 0.0)
        return _with_deviation(share, deviation) if share or deviation else "none"

    return cell


_CARBON = (
    "{share} by mass ± {deviation} of it (1σ): {factor:.4f} % of sulphur per ppb of SO2 per ppm of"
    " CO2"
)
_SULPHATE = "{share} of the sulphur leaves as sulphate: stated, not corrected"
_SCRUBBER = (
    "none is assumed: of a ship with a scrubber the content is that of a fuel which emits as much"
    " SO2 per CO2 without one, and not that of the fuel on board"
)
_VERDICT = (
    "“above” where the content is more than {guard:.3f} standard uncertainties above the limit;"
    " “below” where the fuel is below it with a probability of more than {confidence}, given that"
    " no content is below 0"
)
_INTERVAL = (
    "the shortest that holds {confidence}, given that no content is below 0: {coverage:.3f}"
    " standard uncertainties on either side far above 0, fewer nearer to it. An interval that"
    " starts at 0 is a one-sided 95 % limit"
)
_QUALITY_A = (
    "CO2 signal to noise of {snr:g}, a standard uncertainty of {uncertainty:g} times the lowest"
    " limit, {passes} passes that agree with p ≥ {agreement:g}"
)


def assumption_table(run: RunData, record: Record) -> Table:
    """Return how the log was read, and the thresholds and assumptions of the analysis."""
    flight, found, carbon = record["flight"], record["estimate"], float(record["carbon"])
    settings = run.manifest.get("settings")
    factors = (
        ", ".join(f"{gas.upper()} times {factor:g}" for gas, factor in flight["scale"].items())
        or "none: units as above"
    )
    missing = (
        ", ".join(number(code, "{:g}") for code in flight["missing"]) or "none but empty cells"
    )
    limits = ", ".join(
        limit_words(float(verdict["limit_percent"])) for verdict in found["verdicts"]
    )
    source = (
        record["instrument"]["source"]
        or "as the configuration states them, but for those that are marked as assumed"
    )
    configured = f"{settings}, SHA-256 {run.manifest['settings_hash']}"
    rows = [
        ["Configuration", configured if settings else "none was given"],
        ["Columns of time and place", _columns(flight["columns"])],
        ["Columns multiplied", factors],
        ["Table", flight.get("table") or "not recorded"],
        ["Codes of missing readings", missing],
        ["Figures of the instrument", source.replace("\n", " ")],
        ["Method", METHODS[found["method"]]],
        [
            "Carbon in the fuel",
            _CARBON.format(
                share=percent(carbon), deviation=percent(CARBON_SD), factor=fsc_factor(carbon)
            ),
        ],
        ["NO and NO2", _unmeasured(record)],
        ["Sulphate", _SULPHATE.format(share=percent(SULPHATE_SHARE))],
        ["Exhaust gas cleaning", _SCRUBBER],
        ["A pass", f"a peak of CO2 of {SNR_LEAST:g} times its noise"],
        ["Limits", f"{limits} m/m"],
        ["A verdict", _VERDICT.format(guard=GUARD, confidence=percent(CONFIDENCE))],
        *_rates(record),
        ["Interval", _INTERVAL.format(coverage=COVERAGE, confidence=percent(CONFIDENCE))],
        [
            "Quality A",
            _QUALITY_A.format(
                snr=SNR_GOOD,
                uncertainty=UNCERTAINTY_GOOD,
                passes=PASSES_GOOD,
                agreement=AGREEMENT_LEAST,
            ),
        ],
    ]
    caption = "How the log was read, and the thresholds and assumptions of the analysis."
    return pairs_table(rows, widths=(1.0, 3.0), caption=caption, breakable=True)


def _rates(record: Record) -> list[list[str]]:
    """Return how often the verdicts and the rule are wrong."""
    verdicts = [from_record(Verdict, verdict) for verdict in record["estimate"]["verdicts"]]
    rows = [
        [f"Verdict on {limit_words(verdict.limit_percent)}", rate_words(verdict)]
        for verdict in verdicts
    ]
    decision = record.get("decision")
    return [*rows, ["Rule", decision_words(from_record(Decision, decision))]] if decision else rows


def _columns(columns: dict[str, str]) -> str:
    """Return what the log calls those columns that are no gas's."""
    return ", ".join(name for key, name in columns.items() if key not in GASES)


def _unmeasured(record: Record) -> str:
    """Return what is assumed of the gases that correct SO2 and are not measured."""
    stated, columns = record["instrument"]["stated"], record["flight"]["columns"]
    so2, said = stated["so2"], []
    for gas, (ratio, deviation) in EXPECTED_PPB_PER_PPM.items():
        measured, responds = gas in columns and gas in stated, so2["cross"].get(gas)
        if not responds and not so2["cross_sd"].get(gas):
            said.append(f"SO2 does not respond to {gas.upper()}")
        elif measured and responds:
            said.append(f"{gas.upper()} is measured, and SO2 corrected for it")
        elif measured:
            said.append(
                f"{gas.upper()} is measured, but SO2 not corrected for it, as its response is not"
                " stated"
            )
        else:
            said.append(
                f"{gas.upper()} is not measured: taken as {ratio:g} ± {deviation:g} ppb per ppm"
                " of CO2 (1σ)"
            )
    return "; ".join(said)
