import pytest

from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment
from scenarios.scenario.files import load_study, with_values
from scenarios.studies.base import TrialStudy


def test_the_sweep_is_the_one_that_was_asked_for():
    # Issue: nu = 0, 0.05, ..., 0.95, r_min = 200 m, V_r = 19.42 m/s, 45 degrees of bank, 400-800 m
    # astern, 30 crossings, 1,500 s.
    sweep = load_study("sweep_nu")
    assert sweep.sweep.nu == pytest.approx([0.05 * i for i in range(20)], abs=1e-12)
    assert (sweep.keepout.radius_m, sweep.guidance.airspeed_mps, sweep.guidance.bank_deg) == (
        200.0,
        19.42,
        45.0,
    )
    assert sweep.start.distance_m == (400.0, 800.0)
    assert (sweep.flight.crossings, sweep.flight.duration_max_s) == (30, 1500.0)


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


def test_a_directory_is_no_scenario(tmp_path):
    with pytest.raises(InputError, match="unknown scenario"):
        load_study(str(tmp_path))


def test_variants_are_checked_like_any_value():
    with pytest.raises(InputError, match=r"unknown key 'guidance\.previev'"):
        with_values(load_study("sweep_nu"), {"guidance.previev": False})


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


def test_an_override_has_its_way_in_every_case():
    experiment = Experiment(
        "paper",
        load_study("paper", ["sweep.nu=[0.3]", "start.course_deg=45.0", "fidelity=kinematic"]),
    )
    requests = [experiment.request(number) for number in range(experiment.flights)]
    assert [r.scenario.vessel.speed_ratio for r in requests if r.flight_id.startswith("sim3")] == [
        0.3
    ]
    assert {request.scenario.start.course_deg for request in requests} == {45.0}


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


def test_instruments_that_are_listed_take_keys_of_their_own_from_overrides_and_from_files_that_extend_the_list(
    tmp_path,
):
    listed, own = tmp_path / "listed.toml", tmp_path / "own.toml"
    listed.write_text('title = "l"\nextends = "sulphur"\npayload = ["sniffer"]\n', encoding="utf-8")
    own.write_text(
        'title = "o"\nextends = "listed.toml"\npayload.sensor = "fast"\n', encoding="utf-8"
    )
    for study in (
        load_study(str(own)),
        load_study(str(listed), ["payload.sensor=fast"]),
        load_study("sulphur", ['payload=["sniffer"]', "payload.sensor=fast"]),
    ):
        assert study.payload.instruments == ("sniffer",)
        assert study.payload.model_extra == {"sensor": "fast"}


def test_a_track_of_ones_own_may_have_manoeuvres_that_end(tmp_path):
    (tmp_path / "track.py").write_text(
        "class Turning:\n    manoeuvres_end = 30.0\n", encoding="utf-8"
    )
    path = tmp_path / "own.toml"
    path.write_text(
        'title = "o"\nvessel.track = "track.py:Turning"\ncriteria.resumes_within_periods = 2.0\n',
        encoding="utf-8",
    )
    assert load_study(str(path)).criteria.resumes_within_periods == 2.0


def test_keeping_out_is_not_required_of_a_circle_which_has_no_vessel():
    with pytest.raises(
        InputError,
        match=r"case 'sim1': criteria\.required is 'keep_out', and a circle has no area to keep out of",
    ):
        Experiment("paper", load_study("paper", ["criteria.required=keep_out"]))
