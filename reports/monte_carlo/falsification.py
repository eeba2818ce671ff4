"""What a report shows of a search for the worst flight: how the search went, and the flights that it kept."""

from typing import Any

import numpy as np
import pandas as pd

from reports.document.blocks import Block, Section, Table, Text
from reports.document.chart import Chart, Line, Panel
from reports.run.columns import clearance
from reports.run.run_data import RunData

_POINTS_MAX = 4000
"""Flights that are shown, at most: an even sample of more."""


def falsification_sections(run: RunData) -> list[Section]:
    """Return the section of a run that searched for the worst flight, and none of any other."""
    config = next(iter(run.manifest["trials"].values()))
    flown = run.summary[run.summary["min_distance_m"].notna()]
    if config.get("study") != "falsify" or not len(flown):
        return []
    blocks: list[Block] = [
        Text(_in_words(config, flown)),
        search_chart(flown, int(config["search"]["population"])),
        worst_table(flown, int(config["search"]["kept"])),
    ]
    return [Section(anchor="search", title="Worst-case search", nav_title="Search", blocks=blocks)]


def _in_words(config: dict[str, Any], flown: pd.DataFrame) -> str:
    search = config["search"]
    least = float(np.min(clearance(flown)))
    found = (
        f"The closest that it found stayed {least:.1f} m outside the keep-out area."
        if least >= 0.0
        else f"The worst that it found came {-least:.1f} m into the keep-out area."
    )
    return (
        f"Differential evolution over {len(config['draws'])} inputs within their declared ranges: up to {search['population']}"
        f" flights a generation, {search['generations']} generations after a Sobol sequence. {found} A search finds the worst"
        " flight within its budget and proves no bound. The worst flights are in the directory worst/, as scenario files that"
        " replay them identically."
    )


def search_chart(flown: pd.DataFrame, population: int) -> Chart:
    """Return how close to the keep-out area each flight came, in the order of the search, and the closest so far."""
    number, distance = np.arange(len(flown), dtype=np.float64), clearance(flown)
    every = max(1, -(-len(flown) // _POINTS_MAX))
    median = pd.Series(distance).rolling(population, min_periods=1).median().to_numpy()
    lines = [
        Line(x=number[::every], y=distance[::every], label="a flight", colour="sky", style="points"),
        Line(x=number, y=median, label="median of as many flights as a generation has", colour="orange"),
        Line(x=number, y=np.minimum.accumulate(distance), label="closest so far", colour="blue"),
        Line(x=number[[0, -1]], y=np.zeros(2), label="r_min", colour="vermillion", style="dash"),
    ]
    panel = Panel(x_label="Flights so far [-]", y_label="Distance kept beyond r_min [m]", lines=lines)
    return Chart(name="search", caption="Closest approach of each flight, in the order of the search.", panels=[panel])


def worst_table(flown: pd.DataFrame, kept: int) -> Table:
    """Return the flights that came closest, the worst first."""
    order = np.argsort(clearance(flown), kind="stable")[:kept]
    rows = [
        [
            str(i),
            str(row["flight_id"]),
            f"{float(row['min_distance_m'] - row['keepout_radius_m']):.1f}",
            f"{float(row['keepout_margin_m']):.1f}",
            f"{float(row['nu_min']):.2f} to {float(row['nu_max']):.2f}",
            f"{float(row['wind_speed_mps']):.1f}",
            str(row["turbulence"]),
            f"{float(row['start_distance_m']):.0f}",
            f"{float(row['guard_time_s']):.1f}",
        ]
        for i, (_, row) in enumerate(flown.iloc[order].iterrows(), start=1)
    ]
    head = [
        "", "Flight", "Beyond r_min [m]", "Planned margin [m]", "ν", "Wind [m/s]", "Turbulence", "Start [m]", "Guard [s]",
    ]  # fmt: skip
    return Table(head=head, rows=rows, widths=[0.3, 1.7, 1.0, 1.0, 1.2, 0.8, 1.0, 0.8, 0.8], left_columns=2)
