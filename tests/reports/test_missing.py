"""Pieces of a run that are gone, empty or cut: the report names them, and so does the exit status."""

import shutil

import pytest
from report_parts import flown_text

from reports.document.blocks import Table
from reports.output import flight_figure
from reports.registry import content
from reports.run.run_data import read_run
from reports.run.trials import read_trials
from tests.in_process import assert_refused, run_command
from tests.run_tables import change_manifest, manifest_of, write_manifest
from tests.scenarios.short_trial import short_trial

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run whose manifest says that it had a file of each kind; statistics and a design it has
    not, as if they were gone.
    """
    return flown_text(tmp_path_factory, "short", short_trial(flights=2, duration=8.0))


@pytest.fixture
def copy(whole, tmp_path):
    return shutil.copytree(whole, tmp_path / "copy")


def named(run):
    """Return what the report says is missing: file, state, and what it does not show."""
    sections = [
        section for section in content(read_run(run)).sections if section.anchor == "missing"
    ]
    return [
        tuple(row)
        for section in sections
        for block in section.blocks
        if isinstance(block, Table)
        for row in block.rows
    ]


def had(run, *names):
    """Have the manifest of a run say that it had these files as well."""
    manifest = manifest_of(run)
    manifest["files"] = sorted([*manifest["files"], *names])
    write_manifest(run, manifest)


@pytest.mark.parametrize(
    ("name", "shows"),
    [
        ("flights/short_00000.parquet", "figures of this flight over time"),
        ("columns.json", "titles and units of figures, and those that users' parts add"),
        ("crossings.csv", "crossings in the figures of single flights"),
        ("statistics.json", "probability of a keep-out violation, distributions, sensitivity"),
        ("innerloop.json", "the autopilot: trims, margins, responses"),
    ],
)
def test_a_file_that_is_gone_or_cut_is_named_with_what_is_not_shown_for_it(copy, name, shows):
    if (copy / name).is_file():
        (copy / name).unlink()
    else:
        had(copy, name)
    assert named(copy) == [(name, "is gone", shows)]
    if not name.endswith(".csv"):
        (copy / name).write_text("PAR1, or the beginning of {", encoding="utf-8")
        assert named(copy) == [(name, "cannot be read", shows)]


@pytest.mark.parametrize("text", ["{", '{"summary.csv": {"min_distance_m": ["title"]}}'])
def test_columns_that_cannot_be_read_are_named_and_figures_bear_the_names_of_their_columns(
    copy, text
):
    (copy / "columns.json").write_text(text, encoding="utf-8")
    shown = "titles and units of figures, and those that users' parts add"
    assert named(copy) == [("columns.json", "cannot be read", shown)]
    assert read_run(copy).column("min_distance_m").label == "Min distance [m]"


@pytest.mark.usefixtures("sketched")
def test_the_exit_status_says_that_pieces_are_missing(copy):
    (copy / "flights" / "short_00000.parquet").unlink()
    ended = run_command("reports.build", copy)
    assert ended.status == 1
    missing = copy / "flights" / "short_00000.parquet"
    assert (
        ended.errors.splitlines()[-1]
        == f"missing: {missing} is gone or cannot be read; the report says what it does not show"
    )
    assert "flights/short_00000.parquet" in (copy / "report.html").read_text(
        encoding="utf-8"
    ).replace("<wbr>", "")
    assert (copy / "report.pdf").is_file()


@pytest.mark.parametrize("name", ["../../x", "", 3])
def test_an_export_of_a_run_with_a_name_that_leads_elsewhere_is_refused(copy, name):
    change_manifest(copy, name=name)
    before = sorted(copy.parent.parent.rglob("*"))
    assert_refused(
        run_command("reports.build", copy, "--export", "tracks_csv"),
        "no name of a file; do not use this run",
    )
    assert sorted(copy.parent.parent.rglob("*")) == before


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text[:1000], "' has 0 rows; by verdict.json the run ended with 2: "),
        (lambda text: text[: text.rindex(",")], "' is cut off; "),
        (lambda text: text.replace(",", ";"), "' is not separated by commas: it was saved by"),
        (lambda text: text.replace("False", "maybe"), "' has 'maybe' in criteria_met; it must be"),
        (lambda text: text[:0], "' cannot be read: No columns to parse from file; "),
    ],
)
def test_a_table_that_was_cut_or_saved_otherwise_is_refused_with_its_name_and_the_remedy(
    copy, change, words
):
    table = copy / "summary.csv"
    table.write_text(change(table.read_text(encoding="utf-8")), encoding="utf-8")
    ended = run_command("reports.build", copy)
    assert ended.status == 2
    (line,) = ended.errors.splitlines()
    assert f"'{table}{words}" in line
    assert line.endswith("repeat the run's command with --resume, which writes the tables anew")


def test_flights_of_a_scenario_whose_name_is_all_digits_are_found(copy):
    for table in copy.glob("*.csv"):
        table.write_text(
            table.read_text(encoding="utf-8").replace(",short,", ",2026,"), encoding="utf-8"
        )
    manifest = manifest_of(copy)
    manifest["trials"] = {"2026": manifest["trials"]["short"]}
    write_manifest(copy, manifest)
    run = read_run(copy)
    (trial,) = read_trials(run)
    assert list(trial.rows["flight_id"]) == ["short_00000", "short_00001"]
    assert len(flight_figure(run, "short_00001").axes) > 1


def test_an_export_into_a_link_is_refused(copy, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (copy / "export").symlink_to(tmp_path / "elsewhere")
    assert_refused(run_command("reports.build", copy, "--export", "tracks_csv"), "is a link")
    assert list((tmp_path / "elsewhere").iterdir()) == []
