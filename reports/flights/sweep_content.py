"""The report of a sweep of the speed ratio."""

from reports.design.section import innerloop_section
from reports.document.blocks import Block, FlightContent, FlightPicker, Heading, Section, Table, Text, Verdict
from reports.flights.flight_charts import flight_charts
from reports.flights.speed_ratio_charts import comparison_chart, sweep_charts
from reports.flights.speed_ratio_tables import comparison_table, flight_table, oscillation_table, sweep_parameter_table
from reports.flights.sweep_verdict import verdict
from reports.run.run_data import RunData


def sweep_content(run: RunData) -> tuple[Verdict, list[Section]]:
    """Return the verdict and the sections of the report of a sweep."""
    table = flight_table(run.summary)
    sections = [
        Section(anchor="sweep", title="Over the speed ratio", nav_title="Speed ratio", blocks=[*sweep_charts(run), table]),
        *([_comparison(run)] if len(run.comparison) else []),
        Section(anchor="flights", title="Flights", blocks=[_flights(run, table)]),
        *([innerloop_section(run.innerloop)] if run.innerloop else []),
        Section(
            anchor="parameters",
            title="Parameters",
            blocks=[
                Heading("The reference's oscillation; equation numbers are the paper's"),
                oscillation_table(run),
                Heading("Every parameter of the run"),
                sweep_parameter_table(run),
            ],
        ),
    ]
    return verdict(run), sections


def _comparison(run: RunData) -> Section:
    chart = comparison_chart(run)
    blocks: list[Block] = [
        Text("The same flights, from the same starts, with parts of the guidance changed. They have no part in the verdict."),
        *([chart] if chart else []),
        comparison_table(run),
    ]
    return Section(
        anchor="comparison", title="What each part of the guidance is worth", nav_title="What each part is worth", blocks=blocks
    )


def _flights(run: RunData, table: Table) -> FlightPicker:
    flights = []
    for (_, row), cells in zip(run.summary.iterrows(), table.rows, strict=True):
        name, outcome = f"ν = {row['nu']:.2f}", cells[-1]
        flights.append(
            FlightContent(
                flight_id=str(row["flight_id"]),
                label=f"{name} · {outcome.split(':')[0]}",
                title=f"Flight at {name}: {outcome}",
                charts=flight_charts(run, row),
            )
        )
    return FlightPicker(flights=flights)
