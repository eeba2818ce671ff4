"""Keys that are swept or sampled without effect: refused by name, unless some flight uses them."""

import pytest

from scenarios.errors import InputError
from scenarios.experiment.points import points_of
from scenarios.scenario.consistency import unsteady
from scenarios.scenario.files import load_study

LAG = 'sweep."kinematic.heading_rate_lag_s" = [0.1, 0.2]\n'
DIRECTION = '[[draws]]\nkey = "wind.from_deg"\nuniform = [0.0, 90.0]\n'
PAPER = "guidance.lyapunov_gain_per_m2 = 0.002\nsweep.nu = [0.3]\n"
GAIN = '"guidance.lyapunov_gain_per_m2" = [0.001, 0.002]\n'


def loaded(folder, text, *overrides):
    path = folder / "own.toml"
    path.write_text(f'title = "own"\n{text}', encoding="utf-8")
    return load_study(str(path), overrides)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            LAG,
            "key 'kinematic.heading_rate_lag_s' in sweep has no effect here: it is used by the kinematic vehicle",
        ),
        (
            DIRECTION,
            "key 'wind.from_deg' in draws has no effect here: it is used by wind: set wind.speed_mps",
        ),
        (f"[sweep]\n{GAIN}", "it is used by the steering law lyapunov: set guidance.law"),
        (
            "[sweep]\nnu = [0.3]\nvessel.speed_mps = [2, 3]\n",
            "'vessel.speed_mps' in sweep has no effect here",
        ),
        (
            "[sweep]\nvessel.speed_ratio = [0.3]\nvessel.speed_mps = [2, 3]\n",
            "'vessel.speed_mps' in sweep has no effect here",
        ),
        (
            'sweep.fidelity = ["kinematic"]\n',
            "key 'fidelity' has no effect in sweep; leave it out there, and set fidelity to 'both'",
        ),
    ],
)
def test_a_swept_or_sampled_key_that_no_flight_uses_is_refused(tmp_path, text, words):
    with pytest.raises(InputError) as refused:
        loaded(tmp_path, text)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "text",
    [
        # A variant has another law, which has no such key either; or it would, and is flown at no
        # swept ratio.
        f'{PAPER}[[comparison.variants]]\nname = "sight"\nset = {{ "guidance.law" = "line_of_sight" }}\n',
        'extends = "sweep_nu"\nguidance.law = "lyapunov"\nguidance.gain_per_s = 0.5\nsweep.nu = [0.3]\n',
    ],
)
def test_a_key_of_another_law_than_flights_and_variants_have_is_refused(tmp_path, text):
    with pytest.raises(
        InputError,
        match=r"has no effect here: it is used by the steering law (lyapunov|cascade or line_of_sight): set",
    ):
        loaded(tmp_path, text)


@pytest.mark.parametrize(
    "text",
    [
        f'fidelity = "both"\n{LAG}',
        f'{LAG}[[comparison.variants]]\nname = "point"\nset = {{ fidelity = "kinematic" }}\n',
        f'[sweep]\n"guidance.law" = ["lyapunov", "cascade"]\n{GAIN}',
        f"sweep.wind.speed_mps = [0, 5]\n{DIRECTION}",
        f'{DIRECTION}[[draws]]\nkey = "wind.speed_mps"\nuniform = [0.0, 5.0]\n',
        f'{DIRECTION}[[comparison.variants]]\nname = "windy"\nset = {{ "wind.speed_mps" = 4.0 }}\n',
        'guidance.tuning = "bounded"\n[sweep]\nguidance.tuning = ["bounded", "given"]\nguidance.epsilon_per_m = [0.005, 0.006]\n',
        f'study = "arena"\n{DIRECTION}[[arena.conditions]]\nname = "windy"\ntitle = "Windy"\nset = {{ "wind.speed_mps" = 4.0 }}\n',
    ],
)
def test_a_swept_or_sampled_key_that_some_flights_use_is_accepted(tmp_path, text):
    assert loaded(tmp_path, text).title == "own"


def test_what_the_refusal_of_a_circle_tells_to_set_is_accepted():
    remedies = ["following.plume=predicted", "flight.until=flown", "comparison.variants=[]"]
    assert load_study("plume_search", ["guidance.mission=standoff", *remedies]).stands_off


def test_a_setting_of_smoke_is_accepted_beside_what_it_needs():
    overrides = [
        "plume.structure_length=0.5",
        "plume.structure_intensity=0.3",
        "plume.meander_length_up=1",
    ]
    assert load_study("sulphur", overrides).plume.model == "fluctuating"
    assert load_study(
        "sulphur", ["plume.structure_length=0.5", "sweep.plume.structure_intensity=[0.0,0.3]"]
    )


def test_the_height_of_the_wind_needs_a_profile_also_where_its_speed_is_sampled():
    with pytest.raises(
        InputError, match=r"'wind\.height_m' has no effect here.*set wind\.roughness_m"
    ):
        load_study("plume_search", ["wind.height_m=20"])
    assert (
        load_study("plume_search", ["wind.height_m=20", "wind.roughness_m=0.0002"]).wind.height_m
        == 20.0
    )


def test_a_key_of_the_file_may_lose_its_effect_by_an_override_but_one_of_the_override_must_have_one(
    tmp_path,
):
    speed = '[[draws]]\nkey = "wind.speed_mps"\nuniform = [0.0, 5.0]\n'
    follows = 'guidance.mission = "follow"\n'
    assert [
        draw.key for draw in loaded(tmp_path, follows + DIRECTION + speed, "wind.speed_mps=0").draws
    ] == ["wind.from_deg"]
    for override in (
        'sweep."wind.from_deg"=[0, 90]',
        "sweep.wind.from_deg=[0, 90]",
        'draws=[{key="wind.from_deg",uniform=[0, 9]}]',
    ):
        with pytest.raises(
            InputError, match=r"key 'wind\.from_deg' in (sweep|draws) has no effect here"
        ):
            loaded(tmp_path, follows, override)


TRACKS = "guidance.mission=track"


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("sea_wind", "wind.speed_mps"),
        ("sea_turbulence_light", "turbulence.level"),
        ("sea_manoeuvres", "reports.interval_s"),
        ("ship_from_ais", "vessel.track"),
        ("arena", "emission.ship"),
        ("sulphur", "emission.ship"),
    ],
)
def test_an_override_by_which_air_vessel_or_equipment_would_go_is_refused_with_the_mission(
    name, key
):
    # Each of them has the key from its file, from a base or from its random variables.
    assert key in unsteady(load_study(name))
    with pytest.raises(
        InputError,
        match=r"^key '[a-z_.]+' has no effect here: .* guidance\.mission 'track' is in still air",
    ):
        load_study(name, [TRACKS])


def test_a_mission_without_wind_is_refused_beside_a_base_with_wind_and_in_one_of_the_points(
    tmp_path,
):
    words = (
        r"key 'wind\.speed_mps' has no effect here: .* guidance\.mission 'track' is in still air"
    )
    with pytest.raises(InputError, match=words):
        loaded(tmp_path, 'extends = "sea_wind"\nguidance.mission = "track"\n')
    points = '[[comparison.variants]]\nname = "paper"\nset = { guidance.mission = "track" }\n'
    with pytest.raises(InputError, match=rf"^comparison 'paper': {words}"):
        points_of(loaded(tmp_path, f"wind.speed_mps = 5.0\n{points}"))


def test_an_override_may_turn_the_wind_off_for_a_mission_without_it():
    calm = load_study("sea_wind", ["wind.speed_mps=0", TRACKS])
    assert not calm.follows
    assert not calm.wind.blows
    assert load_study("sweep_nu", [TRACKS]).guidance.mission == "track"
