"""Title, author, organisation and logo of reports that exist, and runs that cannot be reported on."""

import shutil

import pytest
from PIL import Image

from reports.errors import ReportError
from reports.run.letterhead import parse_settings
from tests.in_process import run_command


@pytest.fixture
def run_path(one_path, tmp_path):
    return shutil.copytree(one_path, tmp_path / "run")


@pytest.mark.usefixtures("sketched")
def test_reports_of_a_run_that_exists_take_another_title_and_logo_and_leave_the_run_as_it_is(
    run_path, tmp_path
):
    logo = tmp_path / "logo.jpg"
    Image.new("RGB", (40, 20), "navy").save(logo)
    before = (run_path / "manifest.json").read_bytes()
    settings = [
        f"report.logo={logo}",
        "report.title='Over the strait'",
        "report.organisation=Agency",
    ]
    ended = run_command(
        "reports.build", run_path, *(word for setting in settings for word in ("--set", setting))
    )
    assert ended.status == 0, ended.errors
    page = (run_path / "report.html").read_text(encoding="utf-8")
    assert "<h1>Over the strait</h1>" in page
    assert "A. Author, Agency" in page
    assert "data:image/jpeg;base64," in page
    assert (run_path / "manifest.json").read_bytes() == before


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("report.titel=x", "did you mean 'report.title'?"),
        ("title=x", "sets nothing of a report"),
        ("report.title", "sets nothing of a report"),
        ("seed=3", "reports have report.title, report.author, report.organisation, report.logo"),
        ("report.logo=gone.png", "report.logo: 'gone.png' cannot be read"),
    ],
)
def test_a_setting_that_reports_do_not_have_is_refused(override, said):
    with pytest.raises(ReportError) as error:
        parse_settings([override])
    assert said in str(error.value)
