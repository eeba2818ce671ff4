"""The catalog and its bases."""

import tomllib

import pytest

from scenarios.scenario.files import CATALOG, bases, catalog, load_document, load_study


def own(path):
    """Return what a file itself says."""
    return tomllib.loads(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", catalog())
def test_every_scenario_of_the_catalog_is_valid_and_says_what_it_is(name):
    study = load_study(name)
    assert study.title
    assert study.description.endswith(".")
    # By today's words.
    assert own(catalog()[name]).get("study", "flights") == study.study


def test_no_block_of_equipment_stands_twice():
    blocks = [
        (section, tuple(sorted(map(str, document[section].items()))))
        for path in sorted(CATALOG.rglob("*.toml"))
        for document in [own(path)]
        for section in ("reports", "sensors", "following")
        if section in document
    ]
    assert len(blocks) == len(set(blocks))
    assert [section for section, _ in blocks if section != "following"] == ["reports", "sensors"]


@pytest.mark.parametrize(
    ("base", "names"),
    [
        ("winds", ["sea_wind", "sea_approach"]),
        (
            "turbulent_winds",
            ["sea_turbulence_light", "sea_turbulence_moderate", "sea_turbulence_severe"],
        ),
        ("ais", ["sea_manoeuvres"]),
        ("sensor_errors", ["sea_together", "sea_faults"]),
        ("random_conditions", ["monte_carlo", "falsify"]),
    ],
)
def test_files_share_a_base_and_are_operational_by_it(base, names):
    assert base in bases()
    for name in names:
        assert own(catalog()[name])["extends"] == base
        scenario = load_study(name)
        assert scenario.guidance.mission == "follow"
        assert scenario.start.spread_deg == 180.0


def test_what_extends_a_shared_base_has_its_equipment():
    first, *others = shared = [
        load_study(name) for name in ("sea_together", "sea_faults", "monte_carlo", "falsify")
    ]
    for scenario in others:
        assert scenario.reports == first.reports
        assert scenario.sensors == first.sensors
        assert scenario.following == first.following
    assert {scenario.guidance.reserve for scenario in shared} == {0.1}
    assert first.reports.interval_s == (2.0, 10.0)
    assert first.sensors.heading_bias_deg == 2.0
    # The vessel that manoeuvres is reported alike, and followed with another allowance, without
    # sensor errors.
    manoeuvres = load_study("sea_manoeuvres")
    assert manoeuvres.reports == first.reports
    assert (
        manoeuvres.following.vessel_acceleration_mps2,
        manoeuvres.following.speed_error_mps,
    ) == (0.17, 0.5)
    assert manoeuvres.sensors.heading_bias_deg == 0.0


@pytest.mark.parametrize("study", ["monte_carlo", "falsify"])
def test_a_study_with_random_variables_and_without_a_base_is_operational(tmp_path, study):
    path = tmp_path / "old.toml"
    path.write_text(
        f'study = "{study}"\ntitle = "old"\n[[draws]]\nkey = "wind.speed_mps"\nuniform = [0, 5]\n',
        encoding="utf-8",
    )
    assert load_document(str(path))["guidance"] == {"mission": "follow"}
