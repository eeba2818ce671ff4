"""The report of a measured flight, with other gases."""

from collections.abc import Sequence
from datetime import date

import numpy as np

from measurement.engine import CONTROL_AREAS, TIERS, limit_of
from measurement.estimate.gas import SCREENING, error_words
from measurement.estimate.verdict import REJECTED
from reports.document.blocks import Block, Card, Findings, Section, Table, Verdict
from reports.document.chart import Chart, Line, Panel, Style
from reports.document.palette import Meaning
from reports.document.tables import number
from reports.measurement.charts import (
    budget_chart,
    channels_chart,
    logged_track_chart,
    over_time_chart,
    regression_chart,
)
from reports.measurement.data import Record, logged_facts, read_estimate, read_samples, value
from reports.measurement.instrument_tables import assumption_table, instrument_table
from reports.measurement.tables import record_table, result_table
from reports.measurement.verdict import measurement_verdict
from reports.run.run_data import RunData

_RPM = np.geomspace(60.0, 2400.0, 120)
"""Rated speeds at which the limits are drawn [1/min]."""


def gas_verdict(record: Record) -> Verdict:
    """Judge a flight without SO2: it fails where a gas is above its limit."""
    found: list[Record] = record["gases"]
    judged = [of for of in found if of["verdict"] is not None]
    sides = [_verdict(of) for of in judged]
    words = [
        f"{of['title']} {_printed(of, 'value')} {of['unit']}"
        f" ({_printed(of, 'low')} to {_printed(of, 'high')})"
        + (f", limit {_limit(of)}: {_verdict(of)}" if of in judged else "")
        for of in found
    ]
    return Verdict(
        holds="above" not in sides,
        complete=bool(sides) and all(side == "below" for side in sides),
        headline=f"{words[0]}",
        detail=". ".join([*words[1:], *([SCREENING.capitalize()] if judged else [])]),
        failures=[
            f"{of['title']}, quality {of['quality']}: {reason}"
            for of in found
            for reason in of["quality_reasons"]
        ],
        figures=[
            Card(
                f"{of['figure'][0].upper()}{of['figure'][1:]}",
                f"{_printed(of, 'value')} {of['unit']}",
                note=f"95 % interval {_printed(of, 'low')} to {_printed(of, 'high')}",
            )
            for of in found
        ],
    )


def gas_sections(record: Record, *, with_samples: bool = True) -> list[Section]:
    """Return the section on other gases; none where the log has none."""
    blocks = gas_blocks(record, with_samples=with_samples)
    if not blocks:
        return []
    return [Section(anchor="gases", title="Other gases", nav_title="Gases", blocks=blocks)]


def gas_blocks(record: Record, *, with_samples: bool = True) -> list[Block]:
    """Return a table of other gases, and their charts; none where a record has none."""
    found: list[Record] = record.get("gases") or []
    if not found:
        return []
    charts: list[Block | None] = [samples_chart(found) if with_samples else None]
    charts.append(stage_chart(found))
    return [gas_table(found), *(chart for chart in charts if chart is not None)]


def gas_table(found: list[Record]) -> Table:
    """Return figure, uncertainty, limit, verdict and quality of each gas."""
    rows = [
        [
            of["title"],
            f"{of['figure']} [{of['unit']}]",
            _printed(of, "value"),
            _printed(of, "total"),
            f"{_printed(of, 'low')} to {_printed(of, 'high')}",
            error_words(_largest(of), of["title"]),
            _limit(of),
            _verdict(of),
            of["quality"],
        ]
        for of in found
    ]
    reasons = [
        f" {of['title']} has quality {of['quality']}: {'; '.join(of['quality_reasons'])}."
        for of in found
        if of["quality_reasons"]
    ]
    no_limit = [f" {of['title']}: {of['no_verdict']}." for of in found if of["verdict"] is None]
    judged = f" NOx: {SCREENING}." if any(of["verdict"] for of in found) else ""
    return Table(
        caption="Gases by their ratio to CO2, by the same estimate as SO2."
        + "".join([judged, *no_limit, *reasons]),
        head=[
            *("Gas", "Figure", "Value", "1σ", "95 % interval", "Largest part of 1σ"),
            *("Limit", "Verdict", "Quality"),
        ],
        rows=rows,
        widths=[0.9, 1.7, 0.7, 0.6, 1.2, 1.7, 1.2, 0.8, 0.6],
        left_columns=2,
    )


def _printed(of: Record, name: str) -> str:
    return number(of[name], f"{{:.{of['digits']}f}}")


def _largest(of: Record) -> str:
    parts: dict[str, float] = {"noise": value(of, "noise")}
    parts |= {str(name): float(size) for name, size in of["common"].items() if size is not None}
    return max(parts, key=lambda name: parts[name])


def _limit(of: Record) -> str:
    verdict, stage = of["verdict"], of["stage"]
    return "none" if verdict is None else f"{verdict['limit']:.1f}, stage {stage['stage']}"


def _verdict(of: Record) -> str:
    if of["quality"] == REJECTED:
        return "none: quality C"
    return "none" if of["verdict"] is None else str(of["verdict"]["verdict"])


def samples_chart(found: list[Record]) -> Chart | None:
    """Return each gas over CO2 at one response, with its slope; None without samples."""
    panels = []
    for of in found:
        co2, excess = (np.array(of["samples"][name]) for name in ("co2_ppm", "excess"))
        slope = value(of, "slope")
        if len(co2) < 2 or not np.isfinite(slope):
            continue
        ends = np.array([float(co2.min()), float(co2.max())])
        unit = of["slope_unit"].removesuffix(" per ppm")
        fitted = float(excess.mean()) + slope * (ends - float(co2.mean()))
        panels.append(
            Panel(
                x_label="CO2 excess [ppm]",
                y_label=f"Excess [{unit}]",
                title=of["title"],
                lines=[
                    Line(x=co2, y=excess, label="sample", colour="blue", style="points"),
                    Line(x=ends, y=fitted, label="slope", colour="black"),
                ],
            )
        )
    if not panels:
        return None
    return Chart(
        name="gas-samples",
        caption="Each gas over CO2 without background, at the response of the slower channel.",
        panels=panels,
        columns=min(2, len(panels)),
        panel_height=0.17,
    )


def stage_chart(found: list[Record]) -> Chart | None:
    """Return the limits of NOx by rated speed, with what was measured; None without a stage."""
    measured = [
        of
        for of in found
        if of["stage"] is not None and of["rated_rpm"] is not None and of["value"] is not None
    ]
    if not measured:
        return None
    area = next(iter(CONTROL_AREAS))
    keels: list[tuple[str, date, str]] = [
        *((tier[1], tier[0], "") for tier in TIERS),
        ("III", CONTROL_AREAS[area], area),
    ]
    lines = []
    styles: tuple[Style, ...] = ("solid", "dash", "dot")
    for (stage, keel, where), style in zip(keels, styles, strict=True):
        limits = [limit_of(keel, float(rpm), where) for rpm in _RPM]
        curve = np.array([limit.cycle_g_kwh for limit in limits if limit is not None])
        lines.append(
            Line(x=_RPM, y=curve, label=f"stage {stage}", colour=Meaning.LIMIT, style=style)
        )
    for of in measured:
        value_of = value(of, "value")
        error = [[value_of - value(of, "low")], [value(of, "high") - value_of]]
        lines.append(
            Line(
                x=np.array([value(of, "rated_rpm")]),
                y=np.array([value_of]),
                label="measured, 95 % interval",
                colour="blue",
                style="points",
                error=np.array(error),
            )
        )
        if of["verdict"]["limit"] != of["stage"]["cycle_g_kwh"]:
            lines.append(
                Line(
                    x=np.array([value(of, "rated_rpm")]),
                    y=np.array([float(of["verdict"]["limit"])]),
                    label="limit at one load",
                    colour=Meaning.LIMIT,
                    style="cross",
                )
            )
    panel = Panel(x_label="Rated speed of the engine [1/min]", y_label="NOx [g/kWh]", lines=lines)
    return Chart(
        name="stages",
        caption="NOx and the limits of MARPOL Annex VI, regulation 13, over the test cycle.",
        panels=[panel],
        panel_height=0.2,
    )


def measurement_content(run: RunData) -> Findings:
    """Return the findings of a measured flight."""
    record, samples = read_estimate(run), read_samples(run)
    if record["estimate"] is None:
        return _without_sulphur(run, record)
    shown = (
        []
        if samples is None
        else _there(
            regression_chart(samples, record), logged_track_chart(samples), channels_chart(samples)
        )
    )
    result = _there(result_table(record), over_time_chart(record), budget_chart(record))
    sections = [
        Section(anchor="result", title="Result", blocks=result),
        *gas_sections(record),
        Section(anchor="signals", title="Signals", blocks=shown),
        Section(anchor="record", title="Record", blocks=[record_table(record)]),
        Section(
            anchor="instrument",
            title="Instrument and assumptions",
            nav_title="Instrument",
            blocks=[instrument_table(record), assumption_table(run, record)],
        ),
    ]
    figures = record["estimate"]["figures"]
    flown = (
        f"A flight of {figures['duration_s']:.0f} s with {figures['passes']} passes through the"
        " plume."
    )
    pictures = _there(
        over_time_chart(record),
        *([] if samples is None else _there(regression_chart(samples, record))),
    )
    picture = next((chart for chart in pictures if isinstance(chart, Chart)), None)
    return Findings(
        flown=flown,
        verdict=measurement_verdict(record),
        picture=picture,
        sections=sections,
        facts=logged_facts(run, record),
    )


def _without_sulphur(run: RunData, record: Record) -> Findings:
    """Return the findings of a flight that did not measure SO2."""
    figures = record["gases"][0]["figures"]
    return Findings(
        flown=f"A flight of {figures['duration_s']:.0f} s with {figures['passes']} passes through"
        " the plume, without SO2.",
        verdict=gas_verdict(record),
        picture=samples_chart(record["gases"]),
        sections=gas_sections(record, with_samples=False),
        facts=logged_facts(run, record),
    )


def _there(*blocks: Block | None) -> Sequence[Block]:
    return [block for block in blocks if block is not None]
