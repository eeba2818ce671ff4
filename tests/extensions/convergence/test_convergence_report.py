"""Reports of made-up convergence studies: what is counted, listed and said."""

import re

import numpy as np
import pandas as pd
import pytest
from convergence_runs import write_convergence_run
from report_parts import built, draw_all_but, numbers_on_page_1

from reports.build import build_reports
from reports.errors import ReportError
from tests.run_tables import manifest_of, write_manifest


def test_both_reports_are_built_and_self_contained(failed_path, monkeypatch):
    # Page 1 has the figures of distances again.
    draw_all_but(monkeypatch, "first")
    assert "<option" not in built(failed_path)


def change(path, how):
    how(pd.read_csv(path / "summary.csv")).to_csv(path / "summary.csv", index=False)


def without_ensemble(path):
    manifest = manifest_of(path)
    del manifest["config"]["ensemble"]
    write_manifest(path, manifest)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda path: (path / "summary.csv").unlink(), "no summary.csv"),
        (
            lambda path: change(path, lambda rows: rows.assign(law="pursuit")),
            "law is pursuit; known are lyapunov",
        ),
        (
            lambda path: change(path, lambda rows: rows.drop(columns="settling_time_s")),
            "is damaged",
        ),
    ],
)
def test_a_damaged_study_is_refused_in_one_line(damage, words, tmp_path):
    path = write_convergence_run(tmp_path / "run", 6, samples=0)
    damage(path)
    with pytest.raises(ReportError, match=words) as refusal:
        build_reports(path)
    assert "\n" not in str(refusal.value)


def test_every_number_on_page_1_is_that_of_the_summary(failed_path, tmp_path):
    rows = pd.read_csv(failed_path / "summary.csv")
    proven = rows[rows["law"] != "cascade_cut"]
    converged = rows["outcome"] == "converged"
    known = proven[proven["settling_time_predicted_s"].between(0.0, np.inf, inclusive="neither")]
    ratio = (known["settling_time_s"] / known["settling_time_predicted_s"]).median()
    commands = rows.groupby("law")["heading_rate_max_rad_s"].max()
    failures = proven[proven["outcome"] != "converged"]
    expected = {
        *(f"{number}" for number in converged.groupby(rows["law"]).sum()),
        *(f"{number}" for number in rows["law"].value_counts()),
        *(f"{number:.3f}" for number in commands),
        *(f"{number:.0f}" for number in commands),
        *(f"{number}" for number in failures["trajectory"]),
        *(f"{len(of)}" for of in (proven, proven[proven["outcome"] == "converged"])),
        f"{rows['trajectory'].nunique()}",
        f"{rows['settling_time_s'].max():.0f}",
        f"{ratio:.2f}",
        f"{manifest_of(failed_path)['config']['guidance']['heading_rate_max_rad_s']:g}",
        # Equations, by which the laws are named.
        *("24", "30"),
    }
    messages = {
        number
        for text in failures["message"].astype(str)
        for number in re.findall(r"\d+(?:\.\d+)?", text)
    }
    assert numbers_on_page_1(failed_path, tmp_path) <= expected | messages
