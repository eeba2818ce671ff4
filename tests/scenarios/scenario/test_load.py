import pytest

from scenarios.scenario.files import load_study
from scenarios.studies.base import TrialStudy


@pytest.mark.parametrize(
    ("override", "value"),
    [
        ("guidance.preview=false", False),
        ("guidance.law=lyapunov", "lyapunov"),
        ('guidance.law="line_of_sight"', "line_of_sight"),
        ("guidance.epsilon_per_m = 0.01", 0.01),
    ],
)
def test_overrides_set_any_key(override, value):
    key = override.split("=")[0].strip().split(".")[1]
    assert getattr(load_study("sweep_nu", [override]).guidance, key) == value


@pytest.mark.slow
def test_a_trial_in_a_file_is_relative_to_the_list_and_in_an_override_to_the_current_directory(
    tmp_path, monkeypatch
):
    for folder in ("lists", "elsewhere"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "own.toml").write_text(f'title = "{folder}"\n', encoding="utf-8")
    path = tmp_path / "lists" / "list.toml"
    path.write_text(
        'study = "trials"\ntitle = "list"\ntrials = ["own.toml", "sea_wind"]\n', encoding="utf-8"
    )
    monkeypatch.chdir(tmp_path / "elsewhere")
    listed, overridden = load_study(str(path)), load_study(str(path), ['trials=["own.toml"]'])
    assert listed.trials == (str(tmp_path / "lists" / "own.toml"), "sea_wind")
    assert TrialStudy(listed, "list").trials["own"].title == "lists"
    assert TrialStudy(overridden, "list").trials["own"].title == "elsewhere"
