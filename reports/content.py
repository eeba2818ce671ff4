"""A report's content, the same for screen and print."""

from dataclasses import dataclass

from reports.chart import Chart
from reports.flight_charts import flight_charts
from reports.innerloop_charts import innerloop_charts
from reports.run_data import RunData
from reports.sweep_charts import comparison_chart, sweep_charts
from reports.tables import (
    Table,
    comparison_table,
    flight_table,
    margin_table,
    oscillation_table,
    parameter_table,
    provenance_table,
    step_table,
    trim_table,
)
from reports.verdict import Verdict, verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightContent:
    """One flight: its id, speed ratio, outcome in words, and figures."""

    flight_id: str
    nu: float
    outcome: str
    charts: list[Chart]


@dataclass(frozen=True, slots=True, kw_only=True)
class Content:
    """A whole report."""

    title: str
    description: str
    changes: str
    verdict: Verdict
    sweep: list[Chart]
    flights_table: Table
    comparison: Chart | None
    comparison_table: Table | None
    flights: list[FlightContent]
    innerloop: list[Chart]
    margins: Table | None
    steps: Table | None
    trims: Table | None
    oscillation: Table
    parameters: Table
    provenance: Table


def content(run: RunData) -> Content:
    """Return everything that a report of ``run`` shows."""
    table = flight_table(run.summary)
    design = run.innerloop
    flights = [
        FlightContent(flight_id=str(row["flight_id"]), nu=float(row["nu"]), outcome=cells[-1], charts=flight_charts(run, row))
        for (_, row), cells in zip(run.summary.iterrows(), table.rows, strict=True)
    ]
    return Content(
        title=run.manifest["title"],
        description=run.manifest["config"]["description"],
        changes=", ".join(run.manifest["overrides"]),
        verdict=verdict(run),
        sweep=sweep_charts(run),
        flights_table=table,
        comparison=comparison_chart(run),
        comparison_table=comparison_table(run) if len(run.comparison) else None,
        flights=flights,
        innerloop=innerloop_charts(design) if design else [],
        margins=margin_table(design) if design else None,
        steps=step_table(design) if design else None,
        trims=trim_table(design) if design else None,
        oscillation=oscillation_table(run),
        parameters=parameter_table(run),
        provenance=provenance_table(run),
    )
