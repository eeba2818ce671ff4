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


def test_a_run_keeps_what_its_reports_say_of_themselves_without_a_path_of_the_machine(tmp_path):
    out, logo = tmp_path / "run", tmp_path / "pictures" / "logo.png"
    logo.parent.mkdir()
    Image.new("RGB", (40, 20), "navy").save(logo)
    (tmp_path / "short.toml").write_text(SHORT + REPORT, encoding="utf-8")
    ended = run_command("scenarios.run", tmp_path / "short.toml", "--out", out)
    assert ended.status == 0, ended.errors
    manifest = manifest_of(out)
    digest = hashlib.sha256(logo.read_bytes()).hexdigest()
    said = {"title": "Survey of the strait", "author": "A. Author", "organisation": "Agency"}
    assert manifest["report"] == said | {"logo": "logo.png", "logo_sha256": digest}
    assert (out / "logo.png").read_bytes() == logo.read_bytes()
    assert str(tmp_path) not in (out / "manifest.json").read_text(encoding="utf-8")
    assert manifest["command"] == "python -m scenarios.run short.toml --out run"
    page = (out / "report.html").read_text(encoding="utf-8")
    for words in ("<h1>Survey of the strait</h1>", "A. Author, Agency", '<img src="data:image/png'):
        assert words in page
