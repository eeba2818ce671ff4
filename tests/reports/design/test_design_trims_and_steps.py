"""Equilibria and step responses of made-up designs: what is drawn and listed."""

import pytest
from design_runs import BANKS_DEG, record

from reports.design.data import complete
from reports.design.response_charts import response_charts
from reports.design.tables import step_table, trim_table
from reports.design.trim_charts import trim_charts, trim_map
from reports.document.palette import Meaning


def test_the_trim_map_has_a_curve_per_bank_and_marks_what_is_at_a_limit():
    design = complete(record())
    panels = {panel.y_label: panel for panel in trim_map(design).panels}
    labels = [line.label for line in panels["Rudder command [-]"].lines]
    assert labels[:3] == ["level", "bank +13°", "bank −13°"]
    assert len([label for label in labels if label.startswith("bank")]) == len(BANKS_DEG) - 1
    marked = next(
        line for line in panels["Elevator effect [-]"].lines if line.label == "at a limit"
    )
    assert marked.x.tolist() == [45.0]
    # Throttle is drawn between the autopilot's stops, a rudder near neutral is not.
    stops = [
        (line.label, line.y[0])
        for line in panels["Throttle command [-]"].lines
        if line.style in ("dash", "dot") and line.colour == Meaning.LIMIT
    ]
    assert stops == [("flight idle", 0.35), ("limit of a control", 1.0)]
    assert "limit of a control" not in labels


def test_a_control_is_drawn_between_its_own_limits_and_called_an_effect_where_it_is_one():
    design = record()
    # Down to 80 % of the lower limit of its effect, which is beyond that of any command.
    design["trims"] = [{**t, "elevator": -1.24} for t in design["trims"]]
    for chart in trim_charts(complete(design)):
        (panel,) = (panel for panel in chart.panels if panel.y_label == "Elevator effect [-]")
        assert [line.y.tolist() for line in panel.lines if line.label == "limit of a control"] == [
            [-1.55, -1.55]
        ]
    assert "2 from stop to stop" in trim_map(complete(design)).caption
    (head,) = (
        name for name in trim_table(complete(design), design["trims"]).head if "Elevator" in name
    )
    assert head == "Elevator effect [-]"


@pytest.mark.parametrize(("stall", "drawn"), [(27.0, False), (40.0, True), (None, False)])
def test_the_stall_is_drawn_where_it_is_near_the_grid(stall, drawn):
    design = complete(record())
    design["envelope"]["stall_airspeed_mps"] = stall
    assert ("stall" in [line.label for line in trim_map(design).panels[0].lines]) == drawn


def test_a_turn_is_drawn_with_its_airspeed_and_aileron_and_each_step_with_the_control_that_makes_it():
    turn, steps = response_charts(complete(record()))
    quantities = [
        "Heading rate [rad/s]",
        "Bank [deg]",
        "Sideslip [deg]",
        "Altitude [m]",
        "Airspeed [m/s]",
    ]
    assert [panel.y_label for panel in turn.panels] == [*quantities, "Aileron command [-]"]
    airspeed, altitude = ["Airspeed [m/s]", "Altitude [m]"], ["Altitude [m]", "Airspeed [m/s]"]
    assert [panel.y_label for panel in steps.panels] == [
        *airspeed,
        "Throttle command [-]",
        *altitude,
        "Elevator effect [-]",
    ]


def test_what_a_step_commands_is_not_among_what_it_should_not_move():
    cells = {
        (row[0].partition(",")[0], row[1]): row[-2:] for row in step_table(complete(record())).rows
    }
    assert cells["airspeed", "flown"][1] == cells["altitude", "flown"][0] == "–"
    assert "–" not in (
        cells["airspeed", "flown"][0],
        cells["altitude", "flown"][1],
        *cells["heading rate", "flown"],
    )
