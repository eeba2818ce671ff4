"""Keys that are swept or sampled without effect: refused by name, unless some flight uses them."""

import pytest

from scenarios.errors import InputError
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
