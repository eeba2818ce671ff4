"""The section ``report``: it is in the manifest and in both reports, and has no effect on the
flights.
"""

import hashlib

import pytest
from PIL import Image

from tests.in_process import run_command
from tests.run_tables import manifest_of

pytestmark = pytest.mark.usefixtures("sketched")

SHORT = """
title = "Short"
fidelity = "kinematic"
guidance.rate_hz = 10.0
seed = 3
vessel.speed_mps = 8.0
flight.crossings = 2
start.distance_m = [300.0, 400.0]
"""
REPORT = """
[report]
title = "Survey of the strait"
author = "A. Author"
organisation = "Agency"
logo = "pictures/logo.png"
"""


@pytest.fixture
def scenario(tmp_path):
    (tmp_path / "pictures").mkdir()
    Image.new("RGB", (40, 20), "navy").save(tmp_path / "pictures" / "logo.png")
    path = tmp_path / "short.toml"
    path.write_text(SHORT + REPORT, encoding="utf-8")
    return path


def test_a_run_keeps_what_its_reports_say_of_themselves_without_a_path_of_the_machine(
    scenario, tmp_path
):
    out = tmp_path / "run"
    ended = run_command("scenarios.run", scenario, "--out", out)
    assert ended.status == 0, ended.errors
    content = (tmp_path / "pictures" / "logo.png").read_bytes()
    assert manifest_of(out)["report"] == {
        "title": "Survey of the strait",
        "author": "A. Author",
        "organisation": "Agency",
        "logo": "logo.png",
        "logo_sha256": hashlib.sha256(content).hexdigest(),
    }
    assert (out / "logo.png").read_bytes() == content
    assert "logo.png" in manifest_of(out)["files"]
    assert str(tmp_path) not in (out / "manifest.json").read_text(encoding="utf-8")
    assert manifest_of(out)["command"] == "python -m scenarios.run short.toml --out run"
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "<h1>Survey of the strait</h1>" in page
    assert "A. Author, Agency" in page
    assert '<img src="data:image/png;base64,' in page
