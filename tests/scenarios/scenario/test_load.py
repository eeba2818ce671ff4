import pytest

from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment
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


@pytest.mark.parametrize(
    ("cases", "words"),
    [
        (
            '[[cases]]\nname = "a"\nset = { "sweep.nu" = [0.3, 0.5] }\n',
            ["case 'a' has sweep.nu = [0.3, 0.5]; give it one speed ratio"],
        ),
        ('[[cases]]\nname = "a"\nset = { fidelity = "kinematic" }\n', ["case 'a' sets fidelity"]),
        (
            '[[cases]]\nname = "a"\nset = { "guidance.gain" = 1.0 }\n',
            ["case 'a': unknown key 'guidance.gain'"],
        ),
    ],
)
def test_cases_that_cannot_be_flown_are_refused_by_name(tmp_path, cases, words):
    path = tmp_path / "cases.toml"
    path.write_text(f'study = "paper"\ntitle = "cases"\n{cases}', encoding="utf-8")
    with pytest.raises(InputError) as refusal:
        Experiment("cases", load_study(str(path)))
    for word in words:
        assert word in str(refusal.value)


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
