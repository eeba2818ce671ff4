"""Aircraft that JSBSim brings fly the study: a jet trainer, and a light aircraft with more weight."""

import math

import pytest
from study_runs import AT_THE_SHIP, assert_flown_as_the_issue_asks, flown_once, fly_study

from reports.document.blocks import Table
from reports.document.chart import Chart
from reports.registry import content
from reports.render.html import write_html
from reports.run.run_data import read_run
from scenarios.errors import InputError

# One of the issue's three speed ratios, for the suite's three minutes. All three were flown by all,
# the c172x and the c310, too; a flight of the 737 took up to 13 s and is left to the command line;
# its design is checked in tests/verification.
NU = 0.5
# Nine crossings of 30, as a crossing takes up to 65 s: what a panel of a comparison shows.
SHORT = ("flight.crossings=9",)
WITH_A_COMPARISON = 'comparison={ nu = [0.5], variants = [{ name = "no_preview", set = { "guidance.preview" = false } }] }'


@pytest.fixture(scope="module")
def t37(designs, tmp_path_factory):
    designs("T37")
    return fly_study(
        tmp_path_factory.mktemp("T37") / "run", "T37", *SHORT, WITH_A_COMPARISON, nus=(NU,)
    )


def test_a_jet_trainer_flies_the_sweep(t37):
    assert_flown_as_the_issue_asks(t37.rows[NU])


def test_a_light_aircraft_flies_the_sweep_and_its_rudder_keeps_it_from_slipping(
    heavy_design, tmp_path
):
    run = fly_study(
        tmp_path / "run", heavy_design.design.schedule.spec.folder, "flight.crossings=5"
    )
    ((nu, row),) = run.rows.items()
    assert_flown_as_the_issue_asks(row)
    # Turns are coordinated by the rudder. Measured once settled: 0.013 deg; asserted is four times
    # that, and a fortieth of what the Aerosonde slipped without its rudder.
    assert run.settled(nu)["sideslip_rad"].abs().max() < math.radians(0.05)
    # The X8's own 1.5 m of altitude, though it is given more; measured 0.2 m.
    assert row["altitude_error_max_m"] <= 1.5


def test_its_airspeeds_are_named_where_the_scenario_leaves_them(t37, tmp_path):
    # Found by trimming it: from 1.3 times its stall in the steepest turn, 58.7 m/s, to 1.6 times
    # that.
    with pytest.raises(
        InputError,
        match=r"airspeed_mps is 50; T37 flies 58\.7 to 93\.9 m/s: choose an airspeed in between",
    ):
        fly_study(tmp_path / "slow", "T37", *SHORT, "guidance.airspeed_mps=50.0")
    with pytest.raises(
        InputError,
        match=r"asks for 45\.0 deg of bank; the autopilot of T37 stops at 35: lower guidance\.bank_deg",
    ):
        fly_study(tmp_path / "steep", "T37", *SHORT, "guidance.bank_deg=45.0")
    assert list(tmp_path.iterdir()) == []


def test_an_aircraft_that_pushes_over_to_a_glide_in_its_turn_away_keeps_out(designs, tmp_path):
    # A law flies a jet trainer at the ship, and its engines fail. As it pushes over it turns more
    # slowly, and came in by 4.2 m, as long as the guard did not allow for that.
    designs("T37")
    keys = {
        "aircraft": "T37", "vessel.speed_mps": 55, "start.distance_m": [7500, 9500], "start.aspect_deg": 180,
        "start.course_deg": 180, "reference.standoff_radius_m": 90000, "fault.kind": "engine", "fault.at_s": [52, 52],
        "flight.duration_max_s": 120, "flight.crossings": 0, "flight_seed": 1871587661,
    }  # fmt: skip
    row = flown_once(tmp_path / "run", "sea_wind", keys, *AT_THE_SHIP)
    assert row["guard_time_s"] > 1.0
    assert row["min_distance_m"] > row["keepout_radius_m"]


@pytest.fixture(scope="module")
def report(t37):
    return content(read_run(t37.path))


def test_the_report_of_its_run_names_it_and_shows_it_to_its_own_scale(report, tmp_path):
    write_html(report, tmp_path / "report.html")
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "of the T37 in six degrees of freedom" in html
    blocks = [block for section in report.sections for block in section.blocks]
    charts = {block.name: block for block in blocks if isinstance(block, Chart)}
    # Half of what a comparison's panel could show is there to be seen, after settling and within
    # the settling band.
    for line in charts["trial1-comparison"].panels[0].lines:
        (_, last), (_, top) = (
            charts["trial1-comparison"].panels[0].x_range,
            charts["trial1-comparison"].panels[0].y_range,
        )
        assert line.x[-1] > 0.9 * last
        assert (line.y <= top).all()
    # Beside a vessel at 38 m/s, until it has settled and for 9 crossings every 65 s: forty
    # kilometres.
    tracks = report.picture
    assert tracks.panels[0].x_label == "Right of the plume's axis [km]"
    assert tracks.panels[-1].x_label == "Along the ship's way [km]"
    (way,) = (line for line in tracks.panels[-1].lines if line.label == "ship's track")
    assert way.x.max() == pytest.approx(41.0, abs=5.0)
    # Fitted limits have three digits.
    assert {card.name: card.limit for card in report.verdict.figures}[
        "Tracking error, rms after settling"
    ] == ("≤ 40.1 m, scaled to the aircraft")
    assert not [block for block in blocks if isinstance(block, Table) and not block.rows]


def test_the_report_of_its_run_does_not_speak_of_the_x8(report):
    said = [report.verdict.headline, report.verdict.detail]
    said += [
        block.caption
        for section in report.sections
        for block in section.blocks
        if isinstance(block, Chart)
    ]
    assert not [text for text in said if "X8" in text or "propeller" in text]
