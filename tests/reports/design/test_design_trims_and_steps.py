"""Equilibria and step responses of made-up designs: what is drawn and listed."""

from design_runs import BANKS_DEG, record

from reports.design.data import complete
from reports.design.tables import step_table
from reports.design.trim_charts import trim_map
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
    panels = trim_map(complete(design)).panels
    (panel,) = (panel for panel in panels if panel.y_label == "Elevator effect [-]")
    assert [line.y.tolist() for line in panel.lines if line.label == "limit of a control"] == [
        [-1.55, -1.55]
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
