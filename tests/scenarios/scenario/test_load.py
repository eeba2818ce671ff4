import pytest

from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment
from scenarios.scenario.load import load_study, with_values
from scenarios.studies.trials import TrialStudy


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


def test_what_is_wrong_in_a_file_names_the_file_and_what_is_wrong_in_an_override_does_not(tmp_path):
    file = tmp_path / "own.toml"
    file.write_text('title = "t"\n[winds]\nspeed_mps = 5.0\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"own\.toml: unknown key 'winds'; did you mean 'wind'\?$"):
        load_study(str(file), ["seed=3"])
    file.write_text('title = "t"\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"^unknown key 'winds'"):
        load_study(str(file), ["winds.speed_mps=5"])


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("keepout.radius_m=-5", ["keepout.radius_m", "is -5; it must be at least 10 m"]),
        ("keepout.radius_m=nan", ["keepout.radius_m", "nan", "a finite number in m"]),
        ("keepout.radius_m=wide", ["keepout.radius_m", "'wide'", "number"]),
        ("keepout.radius_m.x=1", ["keepout.radius_m.x", "not a section"]),
        (
            "criteria.crossing_interval_error=no",
            ["criteria.crossing_interval_error is 'no'", "number", ", or false"],
        ),
        (
            "wind.speed_mps=5kn",
            ["wind.speed_mps is '5kn'; it must be a number in m/s, e.g. wind.speed_mps=2.572"],
        ),
        (
            "wind.speed_mps=5 m/s",
            ["wind.speed_mps is '5 m/s'; it must be a number in m/s, e.g. wind.speed_mps=5"],
        ),
        (
            "emission.sulphur_percent=1000ppm",
            ["it must be a number in % m/m, e.g. emission.sulphur_percent=0.1"],
        ),
        ("keepout.radius_m=200yd", ["keepout.radius_m is '200yd'; it must be a number in m"]),
        ("wind.speed_mps=50", ["wind.speed_mps is 50; it must be at most 40 m/s"]),
        ("emission.load=85", ["emission.load is 85; it must be at most 1: a fraction, e.g. 0.85"]),
        ("guidance.preview=maybe", ["guidance.preview is 'maybe'; it must be true or false"]),
        (
            "wind=5",
            [
                "wind: value is 5; it is a section with keys of its own: set one of them, as in wind.speed_mps=..."
            ],
        ),
        ("guidance.law=magic", ["guidance.law", "'magic'", "cascade"]),
        ("guidance.rate_hz=50", ["rate_hz is 50 Hz", "must divide 120 Hz", "e.g. 40"]),
        # Nothing could be logged at so low a rate: flight.log_rate_hz divides it, and is at least
        # 5.
        ("guidance.rate_hz=4", ["guidance.rate_hz is 4; it must be at least 5 Hz"]),
        ("flight.log_rate_hz=7", ["log_rate_hz is 7 Hz", "must divide 20 Hz"]),
        ("start.distance_m=[800, 400]", ["distance_m", "first value must not exceed its second"]),
        ("sweep.nu=[]", ["sweep: nu has no values", "at least one"]),
        ("sweep.nu=[0.5, -0.1]", ["sweep.nu is -0.1", "between 0 and 10"]),
        ("flight.crossings=2.5", ["flight.crossings is 2.5; it must be a whole number"]),
        ("seed=-1", ["seed", "-1"]),
        ("guidance.preview", ["not of the form key=value"]),
        ("sweep.nu=[half]", ["sweep.nu=[half]", "not valid TOML", "quoted"]),
        ("reference.path=circle", ["reference.path is 'circle'", "a case of its own"]),
        (
            "flight.duration_max_s=0.05",
            ["duration_max_s is 0.05 s; at log_rate_hz, 10 Hz", "fly 0.1 s or longer"],
        ),
        ("flight.altitude_m=1", ["flight.altitude_m is 1; it must be at least 5 m"]),
        ("payload.sensor=fast", ["payload: key 'sensor' is not known; set payload.instruments"]),
        ("plume.haze_m=1", ["plume: key 'haze_m' is not known; set plume.model"]),
        ("guidance.command_limit=false", ["command_limit is false", "set fidelity to 'kinematic'"]),
        (
            "start.place_m=[-100, 0]",
            ["start.place_m lies at 100 m", "must exceed keepout.radius_m, 200 m"],
        ),
        (
            "guidance={tuning='bounded', law='lyapunov'}",
            ["tuning is 'bounded' with law 'lyapunov'", "set law to 'cascade'"],
        ),
        (
            "study=magic",
            ["study is 'magic'", "flights, paper, trials, monte_carlo, falsify"],
        ),
        ("study=paper", ["study is 'paper' without cases"]),
        (f"seed={'9' * 5000}", ["--set seed: value 99999999999999999999... has too many digits"]),
        (
            "wind.speed_mps=1\nflights=1",
            ["--set wind.speed_mps: a line break, and 'flights' after it; give each key a --set"],
        ),
        (
            f"sweep.nu={'[' * 3000}{']' * 3000}",
            ["--set sweep.nu: value [[[[[[[[[[[[[[[[[[[[... has too many brackets"],
        ),
        (
            "place.utc=2026",
            ["place.utc: value is 2026, a number; give date and time, as in 2026-06-01T12:00:00Z"],
        ),
        (
            "place.utc=1965-06-01T12:00:00Z",
            ["value is 1965-06-01T12:00:00+00:00; give a time from 1970 to 2199"],
        ),
        (
            f"sweep.start.range_m=[{'9' * 400}]",
            ["start.range_m has a number of more than 308 digits"],
        ),
        (
            "criteria.resumes_within_periods=2",
            ["'criteria.resumes_within_periods' has no effect here", "a vessel that manoeuvres"],
        ),
    ],
)
def test_bad_values_are_refused_in_one_line_that_names_them(override, words):
    with pytest.raises(InputError) as refusal:
        load_study("sweep_nu", [override])
    message = str(refusal.value)
    assert "\n" not in message
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("shares=0.1", "unknown key 'shares'; did you mean 'share'?"),
        ("wnd.speed_mps=5", "unknown key 'wnd'; did you mean 'wind'?"),
        (
            "xyzzy=1",
            "known are study, title, description, trials, share, seed, histories, set, report, and the keys of each trial",
        ),
    ],
)
def test_an_unknown_key_of_a_list_of_trials_is_compared_with_its_own_keys_and_those_of_its_trials(
    override, words
):
    with pytest.raises(InputError) as refusal:
        load_study("sea_trial", [override])
    assert words in str(refusal.value)


def test_an_empty_list_is_refused_without_words_of_the_library():
    with pytest.raises(
        InputError, match=r"^search\.methods: value is \[\]; give at least one value$"
    ):
        load_study("falsify", ["search.methods=[]"])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("title = \n", "not valid TOML"),
        ("[sweep]\nnu = [0.5]\n", "key 'title' is missing"),
    ],
    ids=["not TOML", "key missing"],
)
def test_a_file_of_no_toml_or_with_a_missing_key_is_refused(tmp_path, text, words):
    path = tmp_path / "own.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        load_study(str(path))


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
            '[[cases]]\nname = "a"\n[[cases]]\nname = "a"\n',
            ["cases are named a, a", "a name of its own"],
        ),
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


def test_a_file_with_a_number_of_too_many_digits_is_refused(tmp_path):
    path = tmp_path / "long.toml"
    path.write_text(f'title = "long"\nseed = {"9" * 5000}\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"long\.toml: not valid TOML: .* 5000 digits"):
        load_study(str(path))


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


@pytest.mark.parametrize(
    ("name", "override", "words"),
    [
        (
            "sea_wind",
            "reports.interval_s=5",
            "reports.interval_s: value is 5; give a list in brackets, as in [5, 5]",
        ),
        ("sea_wind", "speed_ratio=low", "as in [400, 800]"),
        ("sweep_nu", "sweep.nu=0.5", "as in [0.5]"),
        ("sea_wind", "vessel.manoeuvres=3", "as in [{ at_s = 100 }]"),
        ("sea_wind", "comparison.variants=3", 'as in [{ name = "name", set = {} }]'),
        ("sea_wind", "payload.instruments=sniffer", 'as in ["sniffer"]'),
        ("convergence", "guidance.laws=cascade", 'as in ["cascade"]'),
    ],
)
def test_a_value_in_the_place_of_a_list_is_refused_with_a_list_of_that_kind(name, override, words):
    with pytest.raises(InputError) as refusal:
        load_study(name, [override])
    assert str(refusal.value).endswith(words)


@pytest.mark.parametrize("value", ["3", "true"])
@pytest.mark.parametrize("key", ["guidance.law", "title"])
def test_a_number_or_truth_value_in_the_place_of_text_is_refused_in_words(key, value):
    with pytest.raises(InputError, match=f"is {value}; it must be text, in quotes"):
        load_study("sea_wind", [f"{key}={value}"])


@pytest.mark.parametrize(
    ("override", "words"),
    [
        (
            "start.distance_m=[1,2,3]",
            "start.distance_m is [1, 2, 3]; it must have 2 values at most, and has 3",
        ),
        (
            'draws=[{key="wind.speed_mps",normal=[1,-5]}]',
            "draws.0.normal.1 is -5; it must be above 0",
        ),
        (
            'cases=[{name="My case"}]',
            "cases.0.name is 'My case'; it must be made of small letters, digits and _ alone",
        ),
    ],
)
def test_what_a_value_must_be_is_said_in_words_and_in_no_unit_that_is_none(override, words):
    with pytest.raises(InputError) as refusal:
        load_study("sweep_nu", [override])
    assert str(refusal.value) == words
