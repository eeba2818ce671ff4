"""Aircraft of the user: a folder with a JSBSim model. What is found of it, what its settings say,
and what is refused.
"""

import math
import re
from pathlib import Path

import jsbsim
import pytest

from aircraft.fleet.find import find_spec
from aircraft.spec import AircraftError
from aircraft.user_check import check_user_aircraft

STOCK = Path(jsbsim.get_default_root_dir())
WEIGHT = '<emptywt unit="LBS"> 1500'  # of the c172p, in its model file
HEAVIER = WEIGHT.replace("1500", "1650")


@pytest.fixture
def heavy(tmp_path):
    """A heavier copy of JSBSim's c172p."""
    folder = tmp_path / "fleet" / "heavy"
    folder.mkdir(parents=True)
    text = (STOCK / "aircraft" / "c172p" / "c172p.xml").read_text(encoding="utf-8")
    assert WEIGHT in text
    (folder / "heavy.xml").write_text(text.replace(WEIGHT, HEAVIER), encoding="utf-8")
    return folder


def refused(name):
    with pytest.raises(AircraftError) as caught:
        find_spec(str(name))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def edited(folder, old, new):
    path = folder / "heavy.xml"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def said(folder, text):
    (folder / "heavy.toml").write_text(text, encoding="utf-8")
    return find_spec(str(folder))


def test_a_folder_is_read_as_jsbsims_own_model_is(heavy):
    mine, stock = find_spec(str(heavy)), find_spec("c172p")
    assert (mine.name, mine.model) == ("heavy", "heavy")
    for name in ("inputs", "configuration", "engine_flags", "settle_time", "envelope", "actuators"):
        assert getattr(mine, name) == getattr(stock, name)


def test_settings_say_title_commands_properties_and_envelope(heavy):
    spec = said(
        heavy,
        'title = "Heavy\\n Cessna"\nelevator = "fcs/elevator-cmd-norm"\nrudder = false\n'
        'throttle = ["fcs/throttle-cmd-norm"]\n'
        "settle_time_s = 12.5\n[properties]\n'fcs/flap-cmd-norm' = 0.5\n"
        "'propulsion/fuel_freeze' = 0\n"
        "[envelope]\nairspeed_min_mps = 40\nairspeed_mps = 45\nairspeed_max_mps = 55\n"
        "bank_deg = 30",
    )
    assert (spec.title, spec.settle_time) == ("Heavy Cessna", 12.5)
    assert [i.name for i in spec.inputs] == ["elevator", "aileron", "throttle"]
    assert dict(spec.configuration)["fcs/flap-cmd-norm"] == 0.5
    assert dict(spec.configuration)["propulsion/fuel_freeze"] == 0.0  # in place of the usual 1
    assert spec.envelope is not None
    assert (spec.envelope.airspeed_min, spec.envelope.airspeed, spec.envelope.airspeed_max) == (
        40.0,
        45.0,
        55.0,
    )
    assert spec.envelope.bank == math.radians(30.0)
    check_user_aircraft(spec)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("elevatr = 'a'", r"unknown key 'elevatr'; did you mean 'elevator'\?"),
        ("elevator = 'fcs/not-there'", r"no elevator command; .* in heavy.toml, elevator = "),
        ("rudder = true", "rudder: give the JSBSim property"),
        ("envelope = 'found'", 'envelope is "found"; '),
        ("[properties]\n'fcs/flap' = 'a'", r'properties\.fcs/flap is "a"; .* number'),
        ("[properties]\nfcs/flap-cmd-norm[1] = 0.33", r"heavy\.toml: not valid TOML.* quotes$"),
        ("settle_time_s = 1000", "settle_time_s is 1000; it must be less than or equal to 120$"),
        (
            "[envelope]\nairspeed_min_mps=50\nairspeed_mps=45\nairspeed_max_mps=55\nbank_deg=30",
            r"envelope: airspeed is 45 m/s; it must lie between airspeed_min, 50, and",
        ),
    ],
)
def test_settings_that_are_wrong_are_refused_in_a_line(heavy, text, why):
    (heavy / "heavy.toml").write_text(text, encoding="utf-8")
    assert re.search(why, refused(heavy))


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        (
            'file="eng_io320"',
            'file="eng_none"',
            "engine file 'eng_none' is not in .*heavy', .*engine'; put it there",
        ),
        (
            'file="eng_io320"',
            'file="../../../eng_io320"',
            "engine file '../../../eng_io320' leads out of the aircraft's folders",
        ),
        ('file="eng_io320"', r'file="C:\eng_io320"', "leads out"),
        ("<fdm_config", "<fdm", "heavy.xml: not valid XML"),
        ("fcs/aileron-cmd-norm", "fcs/other-cmd", "its controls take no aileron command"),
    ],
)
def test_a_model_that_cannot_be_flown_is_refused_in_a_line(heavy, old, new, why):
    edited(heavy, old, new)
    assert re.search(why, refused(heavy))


def test_an_error_while_the_model_runs_is_one_line_without_a_traceback_that_names_the_model_file(
    heavy,
):
    # In its first time step JSBSim raises an error of its own for an input that nothing sets.
    gain = '<pure_gain name="x/y"><input>no/such</input><gain>1</gain></pure_gain>'
    edited(
        heavy,
        "<flight_control",
        f'<system name="x"><channel name="x">{gain}</channel></system><flight_control',
    )
    with pytest.raises(AircraftError) as caught:
        check_user_aircraft(find_spec(str(heavy)))
    message = str(caught.value)
    file = heavy / "heavy.xml"
    why = rf"aircraft 'heavy': its model does not run: \S*Error: .*no/such.*; correct {file}"
    assert re.fullmatch(why, message)
    assert "Traceback" not in message
    assert "File " not in message
