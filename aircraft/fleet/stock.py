"""Aircraft that come with JSBSim."""

from aircraft.fleet.model_spec import spec_of_model
from aircraft.model_files import ModelFiles, stock_root
from aircraft.spec import AircraftSpec


def stock_names() -> list[str]:
    """Return the names of JSBSim's own aircraft."""
    folder = stock_root() / "aircraft"
    return sorted(
        (entry.name for entry in folder.iterdir() if (entry / f"{entry.name}.xml").is_file()),
        key=str.lower,
    )


def stock_spec(name: str) -> AircraftSpec:
    """Return the spec of one of JSBSim's own aircraft.

    Raises
    ------
    AircraftError : it is not an aeroplane with engines and the usual controls, with the reason
    """
    files = ModelFiles(model=name, folder=stock_root() / "aircraft" / name, roots=(stock_root(),))
    source = f"JSBSim's own model '{name}', gear up, fuel held, its own autopilot off"
    return spec_of_model(files, name=name, source=source)
