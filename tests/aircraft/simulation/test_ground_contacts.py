"""Copies of models without ground contacts: they fly the same, and a model that reads its contacts
keeps them.
"""

from dataclasses import replace

import numpy as np
import pytest

from aircraft.fleet.find import find_spec
from aircraft.model_files import read_xml
from aircraft.simulation.fdm import Fdm
from aircraft.simulation.ground_contacts import leave_out_ground_contacts
from aircraft.simulation.model_copy import copy_model
from aircraft.simulation.state import RigidBodyState

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
    leave_out_ground_contacts(SPEC, root)
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
    leave_out_ground_contacts(SPEC, root)
    assert len(contacts(root)) == 7


def test_a_spec_that_sets_a_property_of_contacts_keeps_them(root):
    leave_out_ground_contacts(replace(SPEC, configuration=(("gear/unit[0]/solid", 1.0),)), root)
    assert len(contacts(root)) == 7


def test_an_aircraft_that_is_trimmed_has_none():
    assert Fdm(SPEC).read("gear/num-units") == 0.0
