"""A sound aircraft keeps its mission when it is ordered to speed up from a slow pace."""

import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.run_tables import rows_of

pytestmark = pytest.mark.slow

# A c172p was lost in this flight. The heavier Cessna flies it here, which other tests design anyway.
# In light turbulence the c172p was ordered from its slowest airspeed to 1.35 times that, beside a
# ship that turns. After 61 s its mean airspeed was so far below the order, and was still falling in
# the mean, that its thrust was taken for lost; it glided into the sea at 70.9 s.
MANOEUVRES = (
    "{at_s=22.2,turn_deg=96,turn_rate_deg_s=2.2331819573996654}",
    "{at_s=81.1,turn_deg=-49,turn_rate_deg_s=2.2331819573996654}",
)
KEYS = (
    "seed=767274",
    "keepout.radius_m=380",
    "vessel.speed_mps=6",
    f"vessel.manoeuvres=[{','.join(MANOEUVRES)}]",
    "following.vessel_acceleration_mps2=1",
    "flight.crossings=0",
    "flight.duration_max_s=90",
    "start.distance_m=[1216,1900]",
    "wind.speed_mps=4",
    "wind.from_deg=-176",
    "turbulence.level=light",
)


def test_a_sound_light_aircraft_that_slows_down_and_speeds_up_as_ordered_is_not_ditched(
    heavy_design, tmp_path
):
    file = tmp_path / "scenario.toml"
    file.write_text('extends = "operational"\ntitle = "sound engine"\n', encoding="utf-8")
    folder = heavy_design.design.schedule.spec.folder
    study = load_study(str(file), [f"aircraft={folder}", *KEYS])
    run_study(study, "sound", tmp_path / "run", executor_factory=InProcessExecutor)
    (row,) = rows_of(tmp_path / "run")
    assert row["outcome"] != "aircraft_lost", row["message"]
    assert row["kept_out"]
    assert not {"retreating", "gliding"} & set(row["modes"].split(", "))
    # It has flown on beyond the moment.
    assert row["duration_s"] >= 89.0
