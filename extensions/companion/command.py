"""The commands ``plume-flight vehicle`` and ``plume-flight companion``."""

import math
import re
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack, closing
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TypeVar

import typer

from common.command_line import refuse
from common.errors import RefusedError
from common.interrupt import terminated_like_interrupted
from common.text import did_you_mean, install_words
from common.verdict import INTERRUPTED, MET

if TYPE_CHECKING:
    from scenarios.studies.base import SingleFlight

Single = TypeVar("Single", bound="SingleFlight")

_PLACE = re.compile(r"(-?[\d.]+),(-?[\d.]+)")

_DEFAULT_HOME = "57.5,11.2"
"""Start of a scenario without a place: in the Kattegat. 0/0 would mean that there is no fix."""

_SYSTEM = 1
"""System number of vehicle and companion."""

_LATITUDE_MAX, _LONGITUDE_MAX = 90.0, 180.0

ScenarioArgument = Annotated[
    str, typer.Argument(metavar="NAME|FILE.toml", help="A scenario of the catalog, or a file.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Override a key; may be repeated."),
]
FlightOption = Annotated[
    str | None,
    typer.Option("--flight", metavar="ID", help="The flight, where the scenario has several."),
]
LockstepOption = Annotated[
    bool,
    typer.Option("--lockstep", help="The companion sets the vehicle's clock; default real time."),
]
LogOption = Annotated[
    Path | None,
    typer.Option("--log", metavar="FILE.tlog", help="Telemetry log of both directions."),
]


def vehicle(
    scenario: ScenarioArgument,
    listen: Annotated[
        str,
        typer.Option(
            metavar="udp://HOST:PORT|tcp://HOST:PORT",
            help="Where ground stations and companions connect to.",
        ),
    ] = "tcp://127.0.0.1:5760",
    lockstep: LockstepOption = False,
    mode: Annotated[
        Literal["LOITER", "GUIDED", "CIRCLE", "RTL"], typer.Option(help="Mode at the start.")
    ] = "LOITER",
    home: Annotated[
        str,
        typer.Option(metavar="LAT,LON", help="Origin of a scenario without a place, in degrees."),
    ] = _DEFAULT_HOME,
    duration: Annotated[
        float | None, typer.Option(help="Longest flight in s; default the scenario's.")
    ] = None,
    parameters: Annotated[
        list[str] | None,
        typer.Option(
            "--param", metavar="NAME=VALUE", help="A parameter, as SYSID_MYGCS=1; may be repeated."
        ),
    ] = None,
    flight: FlightOption = None,
    overrides: SetOption = None,
    sniffer: Annotated[
        str | None,
        typer.Option(
            metavar="udp://HOST:PORT",
            help="Send what the scenario's sniffer reads there, in lines.",
        ),
    ] = None,
    log: LogOption = None,
) -> None:
    """Fly a scenario's aircraft, with its vessel and its air, as a MAVLink vehicle.

    It has ArduPlane's GUIDED mode; the aircraft begins where the scenario's flight does. Exit
    status: 0 its time is up or it was ended by Ctrl-C, 1 the aircraft was lost, 2 bad input.
    """
    try:
        _need_pymavlink()
        status = _serve(
            scenario, listen, lockstep, mode, home, duration, parameters or [], flight,
            overrides or [], sniffer, log,
        )  # fmt: skip
    except RefusedError as error:
        status = refuse(error)
    except KeyboardInterrupt:
        status = MET
    raise typer.Exit(status)


@terminated_like_interrupted()
def _serve(
    name: str,
    listen: str,
    lockstep: bool,
    mode: str,
    home: str,
    duration: float | None,
    parameters: Sequence[str],
    flight: str | None,
    overrides: Sequence[str],
    sniffer: str | None,
    log: Path | None,
) -> int:
    from extensions.companion.plane import PlaneMode
    from extensions.companion.ports import Port, opened
    from extensions.companion.simulation import COMPONENT, Server, Simulation, send_readings
    from scenarios.engine.run_directory import RunDirectory
    from scenarios.flight_runner import FlightRunner
    from scenarios.studies.base import SingleFlight

    origin, given = _home(home), _parameters(parameters)
    single = _flight(SingleFlight, name, overrides, flight)
    with tempfile.TemporaryDirectory(prefix="plume-flight-vehicle-") as folder:
        work = single.work(RunDirectory(Path(folder)))
        if not isinstance(work, FlightRunner):
            raise RefusedError(f"'{name}' has no flights")
        request = work.request(single.task)
        plan, setup = work.plan(request), work.setup_of(request)
        simulation = Simulation(plan, setup, home=origin, mode=PlaneMode[mode], parameters=given)
        if sniffer is not None:
            send_readings(simulation, request, plan, opened("--sniffer", sniffer, listening=False))
        line = opened("--listen", listen, listening=True)
        with Port(line, system=_SYSTEM, component=COMPONENT, log=log) as port:
            print(f"vehicle: {request.scenario.aircraft} at {listen}, mode {mode}", flush=True)
            try:
                ended = Server(simulation, port, lockstep=lockstep).run(
                    duration or plan.duration_max
                )
            finally:
                if math.isfinite(simulation.closest):
                    print(
                        f"closest approach: {simulation.closest:.1f} m at"
                        f" {simulation.closest_at:.1f} s; keep-out radius"
                        f" {plan.keepout_radius:g} m",
                        flush=True,
                    )
                for ship, distance in simulation.others.items():
                    print(f"closest to {ship}: {distance:.1f} m", flush=True)
        print(f"ended: {ended}")
    return MET if ended == "time is up" else 1


def companion(
    scenario: ScenarioArgument,
    connect: Annotated[
        str,
        typer.Option(
            metavar="URL",
            help="The vehicle: tcp://HOST:PORT, udp://HOST:PORT, udpin://HOST:PORT to listen,"
            " serial://DEVICE:BAUD.",
        ),
    ],
    by: Annotated[
        Literal["attitude", "course"],
        typer.Option(help="What is commanded: roll (SET_ATTITUDE_TARGET) or headings."),
    ] = "attitude",
    link: Annotated[
        str,
        typer.Option(
            metavar="latency=S,jitter=S,loss=SHARE,silence=S",
            help="How bad the link is, in each direction.",
        ),
    ] = "",
    simulate_link: Annotated[
        int | None,
        typer.Option(metavar="SEED", help="Simulate that link on a better one, with a seed."),
    ] = None,
    lockstep: LockstepOption = False,
    mmsi: Annotated[
        int | None, typer.Option(help="The vessel; default the only one that reports.")
    ] = None,
    wait: Annotated[
        float, typer.Option(help="For how long vehicle, vessel and GUIDED are waited for, in s.")
    ] = 3600.0,
    ais: Annotated[
        str | None,
        typer.Option(
            metavar="udp://HOST:PORT|tcp://HOST:PORT|serial://DEVICE:BAUD",
            help="An AIS receiver's NMEA, in place of the vehicle's AIS_VESSEL; a UDP address is"
            " listened at.",
        ),
    ] = None,
    sniffer: Annotated[
        str | None,
        typer.Option(
            metavar="udp://HOST:PORT|serial://DEVICE:BAUD",
            help=(
                "Where lines of a sniffer's readings come in: age_s,so2_ppb,co2_ppm,no_ppb,no2_ppb."
            ),
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Run directory; default runs/NAME-DATE-TIME.")
    ] = None,
    flight: FlightOption = None,
    overrides: SetOption = None,
    log: LogOption = None,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Do not write report.html and report.pdf.")
    ] = False,
) -> None:
    """Fly a scenario on a vehicle over MAVLink, from GUIDED on, with the guidance of the study.

    It arms nothing and changes no mode. Ctrl-C gives the vehicle back. It writes a run directory as
    a study does. Exit status: same as ``plume-flight run``.
    """
    try:
        _need_pymavlink()
        status = _fly(
            scenario, connect, by, link, simulate_link, lockstep, mmsi, wait, ais, sniffer, out,
            flight, overrides or [], log, no_report,
        )  # fmt: skip
    except RefusedError as error:
        status = refuse(error)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        status = INTERRUPTED
    raise typer.Exit(status)


def _fly(
    name: str,
    connect: str,
    by: str,
    declared: str,
    simulated: int | None,
    lockstep: bool,
    mmsi: int | None,
    wait: float,
    ais: str | None,
    sniffer: str | None,
    out: Path | None,
    flight: str | None,
    overrides: Sequence[str],
    log: Path | None,
    no_report: bool,
) -> int:
    from common.provenance import command_line
    from extensions.companion.ais_line import AisReceiver
    from extensions.companion.flight import Companion, CompanionFlight
    from extensions.companion.ports import Port, opened, opened_input
    from extensions.companion.quality import Link
    from extensions.companion.vehicle_link import COMPONENT, VehicleLink
    from scenarios.engine.processes import InProcessExecutor
    from scenarios.engine.run_directory import RunDirectory
    from scenarios.engine.runner import fly_study

    quality = Link.of(declared)
    directory = out or Path("runs") / f"{Path(name).stem}-{datetime.now():%Y%m%d-%H%M%S}"
    RunDirectory(directory).refuse_taken()
    single = _flight(CompanionFlight, name, overrides, flight)
    with ExitStack() as held:
        line = opened("--connect", connect, listening=False)
        port = held.enter_context(Port(line, system=_SYSTEM, component=COMPONENT, log=log))
        readings = (
            held.enter_context(closing(opened_input("--sniffer", sniffer))) if sniffer else None
        )
        reports = held.enter_context(closing(opened_input("--ais", ais))) if ais else None
        receiver = AisReceiver(reports) if reports else None
        single.companion = Companion(
            link=VehicleLink(
                port, quality, lockstep=lockstep, simulated=simulated, receiver=receiver
            ),
            quality=quality,
            by=by,
            lockstep=lockstep,
            mmsi=mmsi,
            patience=wait,
            sniffer=readings,
            say=lambda words: print(words, flush=True),
        )
        single.companion.meet()
        result = fly_study(
            single,
            directory,
            executor_factory=InProcessExecutor,
            resume=False,
            progress=lambda *_: None,
            command=command_line("scenarios.cli.main", _without_address(sys.argv)),
        )
        if port.malformed:
            print(f"packets that were no MAVLink, or damaged: {port.malformed}")
        if receiver is not None:
            for words in receiver.lines():
                print(words)
    for text in result.lines:
        print(text)
    print(f"results: {result.directory}")
    if not no_report:
        from reports.build import build_reports

        for path in build_reports(directory):
            print(f"report: {path}")
    return result.verdict.exit_status


def _need_pymavlink() -> None:
    """Refuse to begin without the package.

    Raises
    ------
    RefusedError : it is not installed
    """
    from importlib.util import find_spec

    if find_spec("pymavlink") is None:
        raise RefusedError(f"MAVLink needs the package pymavlink: {install_words('companion')}")


def _flight(kind: type[Single], name: str, overrides: Sequence[str], flight: str | None) -> Single:
    """Return a flight of a scenario: the only one, unless it is named.

    Raises
    ------
    RefusedError : there is no flight, or there are several
    """
    from scenarios.scenario.files import load_study
    from scenarios.studies.base import FlightStudy, study_of

    study = study_of(load_study(name, list(overrides)), Path(name).stem, overrides)
    if not isinstance(study, FlightStudy) or study.chooses_flights:
        raise RefusedError(f"'{name}' is no study whose flights can be flown alone")
    names = [
        of.named(number)[0] for of in study.experiments.values() for number in range(of.counted)
    ]
    if flight is None and len(names) > 1:
        raise RefusedError(
            f"'{name}' has {len(names)} flights, {names[0]} to {names[-1]}; choose one by --flight"
        )
    found = kind.of(study, flight or names[0])
    if found is None:
        raise RefusedError(f"'{name}' has no flight '{flight}'{did_you_mean(str(flight), names)}")
    return found  # type: ignore[return-value]


def _home(text: str) -> tuple[float, float]:
    """Return latitude and longitude [rad] of LAT,LON in degrees."""
    found = _PLACE.fullmatch(text)
    place = (float(found[1]), float(found[2])) if found else (math.nan, math.nan)
    if not (abs(place[0]) <= _LATITUDE_MAX and abs(place[1]) <= _LONGITUDE_MAX):
        raise RefusedError(f"--home is '{text}'; give LAT,LON in degrees, as in {_DEFAULT_HOME}")
    return math.radians(place[0]), math.radians(place[1])


def _parameters(given: Sequence[str]) -> dict[str, float]:
    """Return parameters by name, of NAME=VALUE."""
    found = {}
    for text in given:
        name, _, value = text.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            raise RefusedError(f"--param is '{text}'; give NAME=VALUE") from None
    return found


def _without_address(arguments: Sequence[str]) -> list[str]:
    """Return arguments without the addresses of vehicle and instruments, which are a machine's."""
    shown, hide = [], False
    for argument in arguments:
        name, given, _ = argument.partition("=")
        addressed = name in ("--connect", "--ais", "--sniffer")
        shown.append("ADDRESS" if hide else f"{name}=ADDRESS" if addressed and given else argument)
        hide = addressed and not given
    return shown
