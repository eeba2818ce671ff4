"""Fly an aircraft of your own from a directory: here JSBSim's Cessna 172, heavier by 150 lb."""

from pathlib import Path

import jsbsim

from scenarios import run


def write_heavy_cessna(fleet: Path) -> Path:
    """Write the model into ``fleet/heavy`` and return that folder."""
    cessna = Path(jsbsim.get_default_root_dir()) / "aircraft" / "c172p" / "c172p.xml"
    text = cessna.read_text(encoding="utf-8").replace(
        '<emptywt unit="LBS"> 1500', '<emptywt unit="LBS"> 1650'
    )
    folder = fleet / "heavy"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "heavy.xml").write_text(text, encoding="utf-8")
    (folder / "heavy.toml").write_text('title = "Heavy Cessna"', encoding="utf-8")
    return folder


if __name__ == "__main__":
    folder = write_heavy_cessna(Path("fleet"))
    sweep = run(
        "sweep_nu",
        aircraft=folder,
        nu=[0.3, 0.6],
        flight={"crossings": 4},
        comparison={"variants": []},
    )
    print(
        sweep.manifest["plugins"], sweep.summary[["nu", "criteria_met", "min_distance_m"]], sep="\n"
    )
