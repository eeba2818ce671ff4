"""Equilibria and step responses of made-up designs: what is drawn and listed."""

from design_runs import BANKS_DEG, record

from reports.design.charts import trim_map
from reports.design.data import complete
from reports.design.tables import step_table


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
