"""Copies of JSBSim models: what is left out, what stays, and that the originals stay the same."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.model import copy_model, read_xml, remove_ground_contacts
from aircraft.spec import ModelFiles
from aircraft.state import RigidBodyState

FLIGHT = """<fdm_config name="probe" version="2.0">
  <input port="1139"/>
  <output name="localhost" type="SOCKET" port="1138" rate="20"/>
  <system name="GNCUtilities"/>
  <autopilot name="probe autopilot">
    <property value="1">ap/heading_hold</property>
    <channel name="roll">
      <pure_gain name="Wing Leveler">
        <input>ap/heading_hold</input><gain>2</gain><output>ap/aileron_cmd</output>
      </pure_gain>
      <summer name="ap/named/already"><input>ap/heading_hold</input></summer>
    </channel>
  </autopilot>
  <system name="autothrottle"><property>ap/thrust_hold</property></system>
  <system file="Autopilot"/>
  <system name="map of flaps"><property>flaps/map</property></system>
  <flight_control name="fcs">
    <channel name="servo"><actuator name="fcs/servo">
      <input>fcs/elevator-cmd-norm</input><lag>10</lag>
      <hysteresis_width>0.05</hysteresis_width><deadband_width>0.01</deadband_width>
    </actuator></channel>
  </flight_control>
</fdm_config>"""


@pytest.fixture
def probe(tmp_path):
    """A root with a model that has one of everything that is left out, and a file for its
    autopilot.
    """
    folder = tmp_path / "root" / "aircraft" / "probe"
    (folder / "Systems").mkdir(parents=True)
    (folder / "probe.xml").write_text(FLIGHT, encoding="utf-8")
    (folder / "Systems" / "Autopilot.xml").write_text(
        '<system name="any"><property>ap/from-file</property></system>', encoding="utf-8"
    )
    return tmp_path / "root"


def files(root, model):
    return ModelFiles(model=model, folder=root / "aircraft" / model, roots=(root,))


def copied(root, model, directory, **options):
    return ET.parse(copy_model(files(root, model), directory, **options)).getroot()


@pytest.mark.parametrize(
    ("play", "parts"), [(True, ["hysteresis_width", "deadband_width"]), (False, [])]
)
def test_servos_keep_their_play_only_if_asked_to(probe, tmp_path, play, parts):
    config = copied(probe, "probe", tmp_path / "copy", play=play)
    actuator = next(config.iter("actuator"))
    assert [e.tag for e in actuator if e.tag.endswith("_width")] == parts
    # What a linear model can have stays.
    assert actuator.find("lag").text == "10"


SPEC = find_spec("c172p")
START = RigidBodyState(altitude=60.0, roll=0.2, pitch=0.05, velocity_body=(50.0, 1.0, 3.0))
STATES = (
    "position/h-sl-ft",
    "attitude/phi-rad",
    "attitude/theta-rad",
    "velocities/vt-fps",
    "velocities/r-rad_sec",
)


@pytest.fixture
def root(tmp_path):
    copy_model(SPEC.files, tmp_path)
    return tmp_path


def contacts(root):
    return (
        read_xml(root / "aircraft" / "c172p" / "c172p.xml")
        .getroot()
        .findall("ground_reactions/contact")
    )


def flown(root):
    fdm = Fdm(SPEC, root)
    fdm.place(START)
    fdm.command({"throttle": 0.7, "elevator": -0.02})
    rows = []
    for _ in range(600):
        fdm.run()
        rows.append([fdm.read(name) for name in STATES])
    return np.array(rows)


def test_without_contacts_it_flies_the_same_to_the_last_bit(root):
    with_contacts = flown(root)
    assert len(contacts(root)) == 7
    remove_ground_contacts(SPEC, root)
    assert contacts(root) == []
    np.testing.assert_array_equal(flown(root), with_contacts)
    # It moves, and stays off the ground.
    assert np.ptp(with_contacts[:, 1]) > 0.1
    assert with_contacts[:, 0].min() > 50.0


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize(
    "name", ["gear/unit[1]/WOW", "contact/unit[4]/WOW", "gear/num-units", "fcs/steer-pos-deg[0]"]
)
def test_a_model_that_reads_a_property_of_its_contacts_keeps_them(root, name, encoding):
    (root / "systems").mkdir(exist_ok=True)
    (root / "systems" / "reads.xml").write_text(
        f"<system><property>{name}</property></system>", encoding=encoding
    )
    remove_ground_contacts(SPEC, root)
    assert len(contacts(root)) == 7
