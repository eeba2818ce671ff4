"""Tables of patrols: a row for each patrol beside the oracle, and a row for each ship."""

from typing import Any

import pandas as pd

from measurement.gases import MASS_PERCENT
from reports.document.blocks import Table
from reports.document.tables import number
from reports.patrol.data import Patrol, Patrols


def oracle_table(patrols: Patrols) -> Table:
    """Return what each patrol achieved, beside the oracle."""
    rows = []
    for i, patrol in enumerate(patrols.patrols):
        row = patrol.row
        counts = [
            number(row.get(name), "{:.0f}")
            for name in ("ships", "served", "correct", "wrong", "open", "oracle_verdicts")
        ]
        transit, duration = (row.get(name, float("nan")) for name in ("transit_s", "duration_s"))
        rows.append(
            [
                str(i),
                *counts,
                number(row.get("served_per_hour"), "{:.1f}"),
                number(duration / 60.0, "{:.0f}"),
                number(100.0 * transit / duration if duration else None, "{:.0f}"),
                number(row.get("wind_speed_mps"), "{:.1f}"),
                number(row.get("min_distance_m"), "{:.0f}"),
                number(row.get("others_distance_min_m"), "{:.0f}"),
                number(row.get("keepout_violations"), "{:.0f}"),
            ]
        )
    return Table(
        caption="Each patrol, and the verdicts of an oracle that knows every plume and how long each ship takes. Distances"
        " are the least to the ship that was served, and to any other. Patrols are counted from 0, as in the names of flights.",
        head=[
            "Patrol", "Ships", "Served", "Correct", "Wrong", "Open", "Oracle's", "Served an hour", "Duration [min]",
            "In transit [%]", "Wind [m/s]", "Served ship [m]", "Other ships [m]", "Keep-out violations",
        ],
        rows=rows,
        widths=[0.7, 0.6, 0.7, 0.7, 0.7, 0.6, 0.8, 0.8, 0.8, 0.8, 0.7, 0.8, 0.8, 0.9],
        print_size_pt=6.4,
        breakable=True,
    )  # fmt: skip


def ship_table(patrol: Patrol, index: int) -> Table:
    """Return the verdict on each ship of a patrol, by its number, and when it came."""
    rows = [_ship(ship) for _, ship in patrol.ships.iterrows()]
    return Table(
        caption=f"Ships of patrol {index}: verdicts, and when they came. Ships, and their turns in the order, are counted from 0.",
        head=[
            "Ship", "Speed [m/s]", "ν", "Stack [m]", f"Sulphur, true [{MASS_PERCENT}]", f"measured [{MASS_PERCENT}]",
            "Verdict", "Reached [min]", "Time to find [s]", "Beside her [s]", "told [s]", "Turn", "Oracle's turn",
        ],
        rows=rows,
        widths=[0.5, 0.7, 0.6, 0.6, 0.8, 0.8, 1.5, 0.8, 0.8, 0.8, 0.7, 0.5, 0.7],
        print_size_pt=6.4,
        breakable=True,
    )  # fmt: skip


def _ship(ship: "pd.Series[Any]") -> list[str]:
    return [
        str(ship["ship"]),
        number(ship["vessel_speed_mps"], "{:.1f}"),
        number(ship["nu"], "{:.2f}"),
        number(ship["plume_source_height_m"], "{:.0f}"),
        number(ship["fsc_fuel_percent"], "{:.2f}"),
        number(ship["fsc_percent"], "{:.3f}"),
        _verdict(ship),
        number(ship["reached_s"] / 60.0, "{:.0f}"),
        number(ship["time_to_find_s"], "{:.0f}"),
        number(ship["ended_s"] - ship["reached_s"], "{:.0f}"),
        number(ship["told_service_s"], "{:.0f}"),
        number(ship["position"], "{:.0f}"),
        number(ship["oracle_position"], "{:.0f}"),
    ]


def _verdict(ship: "pd.Series[Any]") -> str:
    if pd.isna(ship["position"]):
        return "not served"
    if ship["verdict"] == "open":
        return "open"
    return f"{ship['verdict']}: {'correct' if ship['verdict'] == ship['truth'] else 'wrong'}"
