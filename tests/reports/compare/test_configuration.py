"""What differs in the configuration and the software of runs."""

import copy
from dataclasses import replace

import pytest

from reports.compare.configuration import configuration_table, software_table
from reports.compare.pairs import read_runs


@pytest.fixture
def two(first, same):
    """Two runs alike, whose manifests may be changed."""
    runs = read_runs([first, same])
    return [_with(run, copy.deepcopy(run.manifest)) for run in runs]


def _with(run, manifest):
    data = replace(run.data, manifest=manifest)
    trials = [
        replace(trial, run=data, config=manifest["trials"][trial.key]) for trial in run.trials
    ]
    return replace(run, data=data, trials=trials)


def cells(runs):
    """Return the values of each key that differs."""
    table = configuration_table(runs)
    return {row[0]: tuple(row[1 : 1 + len(runs)]) for row in table.rows} if table else {}


def config_of(run):
    (config,) = run.manifest["trials"].values()
    return config


def parameters_of(run):
    (listed,) = run.manifest["trial_parameters"].values()
    return listed


def test_runs_alike_differ_in_no_key(two):
    assert configuration_table(two) is None


def test_a_key_that_differs_has_its_unit_and_meaning(two):
    config_of(two[1])["guidance"]["airspeed_mps"] = 20.5
    (row,) = configuration_table(two).rows
    assert row[:4] == ["guidance.airspeed_mps", "19.42", "20.5", "m/s"]
    assert row[4]


def test_a_key_that_one_version_does_not_have_is_said_to_be_none(two):
    del config_of(two[0])["guidance"]["preview"]
    parameters_of(two[0])[:] = [
        of for of in parameters_of(two[0]) if of["key"] != "guidance.preview"
    ]
    assert cells(two) == {"guidance.preview": ("not a key", "yes")}


def software(runs):
    table = software_table(runs)
    bold = {table.rows[i][0] for i, _ in table.bold}
    return {row[0]: row[1:] for row in table.rows}, bold


def test_versions_files_and_hashes_that_differ_stand_out(two):
    two[1].manifest["packages"]["jsbsim"] = "0.9"
    two[1].manifest["fingerprint"]["source"] = "abc"
    # A path of the machine that flew stands in neither.
    two[1].manifest["plugins"] = {"/home/jo/laws/mylaw.py:MyLaw": "0123"}
    interrupted = two[1].data.verdict.once_interrupted(interrupted=True)
    two[1] = replace(two[1], data=replace(two[1].data, judgement=interrupted))
    rows, bold = software(two)
    assert rows["Version of jsbsim"][1] == "0.9"
    assert "jsbsim" not in rows["Other packages"][0]
    assert rows["File mylaw.py:MyLaw"] == ["not used", "0123"]
    assert rows["State"][1] == "interrupted, 3 of 3 flights"
    assert bold == {"Version of jsbsim", "Hash of the source", "File mylaw.py:MyLaw", "State"}
