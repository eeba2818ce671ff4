"""A wrong scenario is refused in one line with the key, its value, the limit, the nearest name."""

import pytest

from scenarios.errors import InputError
from scenarios.planning.guidance import steering_law
from scenarios.scenario.files import load_study

DIGITS = "9" * 5000
CELL = "{t90_s=2,delay_s=0.5,noise=5}"


def refusal(name, *overrides):
    with pytest.raises(InputError) as refused:
        load_study(name, overrides)
    message = str(refused.value)
    assert "\n" not in message
    return message


VALUES = [
    ("keepout.radius_m=-5", "is -5; input should be greater than or equal to 10 [m]"),
    ("keepout.radius_m=nan", "keepout.radius_m is nan; input should be a finite number [m]"),
    ("wind.speed_mps=5kn", "wind.speed_mps is '5kn'; input should be a valid number"),
    ("wind=5", "wind is 5; input should be a valid dictionary"),
    ("start.distance_m=[800, 400]", "is [800.0, 400.0]; its first value must not"),
    ("start.distance_m=[1,2,3]", "is [1, 2, 3]; tuple should have at most 2 items"),
    ("start.distance_m=[400]", "key 'start.distance_m.1' is missing"),
    ("search.mutation=[1.0,0.5]", "its first value must not exceed its second"),
    ("title=", "title: value is ''; give one word at least"),
    ('cases=[{name="My case"}]', "cases.0.name is 'My case'; string should match pattern"),
    ("criteria.tracking_error_rms_m=0", "value is 0; give a limit above 0, or false where"),
    ("place.utc=2026", "place.utc: value is 2026, a number; give date and time"),
    ("place.utc=1965-06-01T12:00:00Z", "give a time from 1970 to 2199"),
    ("sweep.nu=[]", "sweep: nu has no values"),
    ("sweep.nu=[0.5, -0.1]", "sweep.nu is -0.1; speed ratios lie between 0 and 10"),
    (f"sweep.start.range_m=[{'9' * 400}]", "start.range_m has a number of more than 308 digits"),
    # Truth values are no numbers.
    ("wind.speed_mps=true", "wind.speed_mps is true; it must be a number"),
    ("start.distance_m=[true, 500]", "start.distance_m is [true, 500]; it must be a number"),
    ("arena.limits=[[0.5, true]]", "arena.limits is [[0.5, true]]; it must be a number"),
    ("payload={instruments=['sniffer'],limit_percent=true}", "limit_percent is true; it must be"),
    # Names.
    ("wind.form_deg=3", "unknown key 'wind.form_deg'; did you mean 'wind.from_deg'?"),
    ("speed_mps=3", "did you mean 'vessel.speed_mps' or 'wind.speed_mps'?"),
    ("wind.direction=3", "unknown key 'wind.direction'; known in wind are speed_mps, from_deg"),
    ("nu=0.5", "unknown key 'nu'; did you mean 'sweep.nu' or 'vessel.speed_ratio'?"),
    ("vessel.manoeuvres=[{at_s=1, turn_dg=3}]", "did you mean 'vessel.manoeuvres.0.turn_deg'?"),
    ("vessel.manoeuvres.0.turn_deg=90", "vessel.manoeuvres has 0 entries"),
    ("vessel.manoeuvres.².turn_deg=5", "vessel.manoeuvres is {'²': {'turn_deg': 5}}"),
    ("keepout.radius_m.x=1", "unknown key 'keepout.radius_m.x'; 'radius_m' is a value"),
    ("payload.sensor=fast", "payload: key 'sensor' is not known; set payload.instruments"),
    ("turbulence.level=sever", "is 'sever'; did you mean 'severe'? input should be"),
    ("guidance.law=lyapunow", "unknown steering law 'lyapunow'; did you mean 'lyapunov'?"),
    ("guidance.law=mine.py", "names a file, and no part in it; give mine.py:NAME"),
    ("study=monte_karlo", "study is 'monte_karlo'; did you mean 'monte_carlo'? it must be one of"),
    ('criteria.modes_at_end=["traking"]', "'traking' is not a mode; did you mean 'tracking'?"),
    # The form of an override.
    ("guidance.preview", "not of the form key=value"),
    ("extends=sim3", "extends stands in a scenario file"),
    ("sweep.nu=[half]", "--set sweep.nu='[half]' is not valid TOML"),
    (f"seed={DIGITS}", "has too many brackets or digits"),
    (f"sweep.nu={'[' * 3000}{']' * 3000}", "has too many brackets or digits"),
    ("wind.speed_mps=1\nflights=1", "a line break, and 'flights' after it"),
]


@pytest.mark.parametrize(("override", "words"), VALUES, ids=[words for _, words in VALUES])
def test_a_wrong_override_is_one_line_with_key_value_and_limit(override, words):
    assert words in refusal("sweep_nu", override)


TOGETHER = [
    ("sweep_nu", ["guidance.rate_hz=50"], "rate_hz is 50 Hz; it must divide 120 Hz, e.g. 40"),
    ("sweep_nu", ["flight.log_rate_hz=7"], "log_rate_hz is 7 Hz; it must divide 20 Hz"),
    ("sweep_nu", ["reference.path=circle"], "reference.path is 'circle' beside"),
    ("sweep_nu", ["flight.duration_max_s=0.05"], "duration_max_s is 0.05 s; at log_rate_hz, 10 Hz"),
    ("sweep_nu", ["guidance.command_limit=false"], "command_limit is false; an aircraft"),
    ("sweep_nu", ["start.place_m=[-100, 0]"], "place_m lies at 100 m; it must exceed keepout"),
    ("sweep_nu", ["guidance={tuning='bounded', law='lyapunov'}"], "set law to 'cascade'"),
    ("sweep_nu", ["study=paper"], "study is 'paper' without cases"),
    ("sweep_nu", ["study=falsify", "sweep={}", "comparison={}"], "draws is empty"),
    ("sweep_nu", ["fault.kind=engine", "fault.at_s=[100, 1500]"], "fault.at_s ends at 1500 s"),
    ("sea_wind", ["fidelity=kinematic", "turbulence.level=light"], "set fidelity to 'six_dof'"),
    ("sweep_nu", ["reports.interval_s=[1e-9, 1e-9]"], "more than 200000 reports"),
    ("ship_from_ais", ["sweep.vessel.speed_mps=[5, 6]"], "a file that it comes from"),
    ("sulphur", ["plume.source_height_m=500"], "plume.source_height_m is 500 m; exhaust"),
    ("sulphur", ["flight.altitude_m=130"], "altitude_max_m, 20 to 120 m"),
    ("monte_carlo", ["method=subset", "fidelity=both"], "it estimates one probability"),
    ("monte_carlo", ["method=subset", "draws=[]"], "draws is empty"),
    ("falsify", ["sweep.keepout.radius_m=[150, 200]"], "it searches one point"),
    ("falsify", ["search.generations=10000", "search.population=10000"], "the most is 1000000"),
    ("paper", ["sweep.nu=[0.3]", "sweep.wind.speed_mps=[1, 2]"], "beside 4 cases"),
    ("convergence", ["guidance.laws=cascade"], "guidance.laws is 'cascade'; input should be a"),
    ("sea_trial", ["shares=0.1"], "unknown key 'shares'; did you mean 'share'?"),
    ("sea_trial", ["wnd.speed_mps=5"], "unknown key 'wnd'; did you mean 'wind'?"),
    # A hull.
    ("sea_wind", ["vessel.length_m=120"], "length_m is given without beam_m"),
    ("sea_wind", ["vessel.length_m=20", "vessel.beam_m=30"], "it must not exceed length_m, 20 m"),
    ("sea_wind", ["keepout.from=hull"], "set vessel.length_m"),
    (
        "sea_wind",
        ["vessel.length_m=120", "vessel.beam_m=18", "vessel.antenna_from_bow_m=130"],
        "antenna_from_bow_m is 130 m, outside of the hull; it must not exceed length_m, 120 m",
    ),
    # Keys without effect.
    ("sulphur", ["plume.structure_length=0.5"], "set plume.structure_intensity"),
    ("sulphur", ["plume.meander=false", "plume.meander_length_up=1"], "leave plume.meander out"),
    ("sea_wind", ["plume.model=fluctuating", "plume.richardson=0.5"], "set emission.ship"),
    ("sulphur", ["emission.methane_slip_percent=3"], "add the table payload.channels.ch4"),
    ("sulphur", ["payload.channels.co=" + CELL], "the key 'co'"),
    ("sulphur", ["payload.channels.ch4={t90=2}"], "did you mean 't90_s'?"),
    ("sulphur", ["payload.channels.ch4=3"], "give a table [channels.ch4]"),
    ("plume_search", ["guidance.mission=standoff"], "with following.plume 'estimated'"),
    ("sweep_nu", ["sweep.nu=[0.3, 0.6]", "comparison.nu=[0.33]"], "these ratios in sweep.nu, too"),
    ("monte_carlo", ["start.spread_deg=10"], "'start.aspect_deg' is swept or sampled in every"),
    ("falsify", ["search.time_s=60", "search.generations=5"], "leave search.time_s out"),
    ("sweep_nu", ["vessel.speed_mps=5"], "'vessel.speed_mps' has no effect here"),
    ("sweep_nu", ["arena.window_s=20"], "it is used by laws side by side: set study to 'arena'"),
    ("patrol", ["criteria.settles=false"], "a patrol is judged by patrol.oracle_share_min"),
]


@pytest.mark.parametrize(("name", "overrides", "words"), TOGETHER, ids=[of[2] for of in TOGETHER])
def test_what_does_not_go_together_is_one_line(name, overrides, words):
    assert words in refusal(name, *overrides)


WIND = {"key": "wind.speed_mps", "uniform": [0.0, 5.0]}
FROM = {"key": "wind.from_deg", "uniform": [0.0, 90.0]}
RATIO = {"key": "vessel.speed_ratio", "uniform": [0.2, 0.4]}
AIRCRAFT = {"key": "aircraft", "choice": ["x8"]}
GRID = {"wind.from_deg": [*range(200)], "vessel.course_deg": [*range(200)]}
GAINS = {"guidance.lyapunov_gain_per_m2": [0.001, 0.002]}
SAME = [{"name": "own", "set": {"guidance.preview": of}} for of in (True, False)]
SIGHT = {"variants": [{"name": "sight", "set": {"guidance.law": "line_of_sight"}}]}
EMPTY = {"variants": [{"name": "own", "set": {"draws": []}}]}

DOCUMENTS = [
    ({"draws": [{"key": "criteria.settles", "choice": [True]}]}, "draws has 'criteria.settles'"),
    ({"draws": [WIND, WIND]}, "draws has 'wind.speed_mps' 2 times; give a key once"),
    ({"draws": [{**WIND, "normal": [1.0, 1.0]}]}, "has uniform and normal of"),
    ({"draws": [AIRCRAFT]}, "autopilot and margins are worked out once"),
    ({"sweep": {"seed": [1, 2]}}, "sweep has 'seed', which sets nothing of a flight"),
    ({"sweep": {"nu": [0.3], "vessel.speed_ratio": [0.4]}}, "the same; give one of them"),
    ({"sweep": {"nu": [0.3]}, "draws": [RATIO]}, "'vessel.speed_ratio' is in sweep and in draws"),
    ({"sweep": GRID}, "40000 points"),
    ({"cases": [{"name": "own", "set": {"seed": 3}}]}, "case 'own' sets 'seed', on which its"),
    ({"cases": [{"name": "a"}, {"name": "a"}]}, "cases are called a, a; 'a' is there 2 times"),
    ({"comparison": EMPTY}, "comparison 'own' sets 'draws'"),
    ({"comparison": {"variants": SAME}}, "'own' is there 2 times: give each a name of its own"),
    ({"cases": [{"name": "study", "comparison": True}]}, "'study' is there 2 times"),
    ({"wind": {3: 4}, "extends": "sea_wind"}, "'wind' has the key 3"),
    # Keys that are swept or sampled, which no flight uses.
    ({"sweep": {"kinematic.heading_rate_lag_s": [0.1, 0.2]}}, "used by the kinematic vehicle"),
    ({"draws": [FROM]}, "it is used by wind: set wind.speed_mps"),
    ({"sweep": GAINS}, "it is used by the steering law lyapunov: set guidance.law"),
    ({"sweep": GAINS, "comparison": SIGHT}, "it is used by the steering law lyapunov: set"),
    ({"sweep": {"nu": [0.3], "vessel.speed_mps": [2, 3]}}, "in sweep has no effect here"),
    ({"sweep": {"fidelity": ["kinematic"]}}, "leave it out there, and set fidelity to 'both'"),
]


@pytest.mark.parametrize(("document", "words"), DOCUMENTS, ids=[words for _, words in DOCUMENTS])
def test_a_document_whose_experiment_cannot_be_flown_is_one_line(document, words):
    assert words in refusal({"title": "own", **document})


WINDY = {"name": "windy", "set": {"wind.speed_mps": 4.0}}
TUNED = {"guidance.tuning": ["bounded", "given"], "guidance.epsilon_per_m": [0.005, 0.006]}


@pytest.mark.parametrize(
    "document",
    [
        {"sweep": {"guidance.law": ["lyapunov", "cascade"], **GAINS}},
        {"sweep": {"wind.speed_mps": [0, 5]}, "draws": [FROM]},
        {"draws": [FROM, WIND]},
        {"draws": [FROM], "comparison": {"variants": [WINDY]}},
        {"guidance": {"tuning": "bounded"}, "sweep": TUNED},
        {"study": "arena", "draws": [FROM], "arena": {"conditions": [WINDY | {"title": "Windy"}]}},
    ],
)
def test_a_swept_or_sampled_key_that_some_flights_use_is_accepted(document):
    assert load_study({"title": "own", **document}).title == "own"


FILES = [
    ("title = \n", "not valid TOML"),
    ("[sweep]\nnu = [0.5]\n", "key 'title' is missing"),
    ('title = "t"\n[winds]\nspeed_mps = 5.0\n', "own.toml: unknown key 'winds'; did you mean"),
    (f'title = "long"\nseed = {DIGITS}\n', "not valid TOML"),
    ('title = "t"\nextends = "own.toml"\n', "extends goes in a circle"),
    ('title = "t"\nextends = "sea_wnd"\n', "extends: unknown scenario 'sea_wnd'; did you mean"),
    ('title = "t"\nextends = "c.toml"\n', "extends: no scenario file 'c.toml'"),
    ('title = "t"\nextends = 3\n', "extends is 3; give one catalog name"),
]


@pytest.mark.parametrize(("text", "words"), FILES, ids=[words for _, words in FILES])
def test_what_is_wrong_in_a_file_names_the_file(tmp_path, text, words):
    path = tmp_path / "own.toml"
    path.write_text(text, encoding="utf-8")
    message = refusal(str(path), "seed=3")
    assert words in message
    assert "own.toml" in message


LAW = """
from dataclasses import dataclass

@dataclass(frozen=True, kw_only=True)
class Own:
    count: int = 2
    word: "str" = "x"
    flag: bool = False
    gain: float = 2
    def heading_rate(self, *_): return 0.0
"""


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("guidance.count=1.5", "count is 1.5; law"),
        ("guidance.count=true", "takes a whole number, by default 2"),
        ("guidance.word=5", "takes a word in quotation marks, by default 'x'"),
        ("guidance.flag=1", "takes true or false, by default False"),
        ("guidance.gain=much", "gain is 'much'; law"),
        (f"guidance.gain={10**400}", "takes a finite number, by default 2"),
    ],
)
def test_a_key_of_a_law_is_of_the_type_of_its_field(tmp_path, override, words):
    (tmp_path / "own.py").write_text(LAW, encoding="utf-8")
    # Without its comparison with another law, for which keys count as acting.
    law = ("comparison={}", f"guidance.law={tmp_path}/own.py:Own")
    assert words in refusal("sweep_nu", *law, override)
    fitting = ["guidance.count=3", 'guidance.word="y"', "guidance.flag=true", "guidance.gain=0.5"]
    made = steering_law(load_study("sweep_nu", [*law, *fitting]).guidance)
    assert (made.count, made.word, made.flag, made.gain) == (3, "y", True, 0.5)
