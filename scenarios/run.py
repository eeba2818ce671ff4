"""Command line: ``python -m scenarios.run NAME|FILE.toml``. Slow imports wait until they are
needed.
"""

import functools
import inspect
import os
import shlex
import sys
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from common.command_line import refuse, run_command
from common.errors import PluginError
from common.interrupt import terminated_like_interrupted
from common.registry import announced, load_announced
from common.run_layout import REPORT_HTML, REPORT_PDF, flight_of
from common.verdict import INTERRUPTED, MET, UNEXPLAINED

if TYPE_CHECKING:
    from scenarios.engine.runner import ExecutorFactory, Launch
    from scenarios.flight.closed_loop import Viewer

_WATCHED_TIME_LIMIT = 1e6
"""Longest computing time of a flight that is shown in real time [s]."""

VIEWER = "viewer"
"""Group of entry points, ``plume_flight_study.viewer``: what shows a flight that is replayed, a
``scenarios.flight.closed_loop.Viewer``. Its name is an option of the command.
"""


def _option(viewer: str) -> str:
    return f"--{viewer.replace('_', '-')}"


def with_viewers(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command with an option for each viewer that an installed package announces."""
    given = inspect.signature(command)
    parameters = [of for of in given.parameters.values() if of.kind is not of.VAR_KEYWORD]
    for name in sorted(announced(VIEWER)):
        option = typer.Option(
            _option(name),
            metavar="ADDRESS",
            help=f"Replay a flight in real time, shown by {name} at this address.",
        )
        parameters.append(
            inspect.Parameter(
                name,
                inspect.Parameter.KEYWORD_ONLY,
                default=None,
                annotation=Annotated[str | None, option],
            )
        )

    @functools.wraps(command)
    def with_options(*args: Any, **options: Any) -> None:
        command(*args, **options)

    with_options.__signature__ = given.replace(parameters=parameters)  # type: ignore[attr-defined]
    with_options.__annotations__ = {of.name: of.annotation for of in parameters}
    return with_options


@with_viewers
def command(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME|FILE.toml|RUN/flights/ID",
            help="A scenario of the catalog, a scenario file, or a flight to replay.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Run directory; default runs/NAME-DATE-TIME.")
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, max=256, help="Number of processes; default one per core.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of the study, as --set seed=SEED.")
    ] = None,
    overrides: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Override a key, e.g. guidance.preview=false; may be repeated.",
        ),
    ] = None,
    executor: Annotated[
        Literal["local", "dask"],
        typer.Option(help="Processes of this machine, or a Dask cluster (needs the extra 'dask')."),
    ] = "local",
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="tcp://HOST:PORT",
            help="Address of a running Dask scheduler; default a cluster on this machine.",
        ),
    ] = None,
    time_limit: Annotated[
        float, typer.Option(help="Longest computing time of a flight, in seconds.")
    ] = 600.0,
    memory_limit: Annotated[
        float | None, typer.Option(help="Memory limit of a process, in GiB; default none.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue the unfinished run in --out.")
    ] = False,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Do not write report.html and report.pdf.")
    ] = False,
    aircraft_dir: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Directory with JSBSim models of your own, DIR/NAME/NAME.xml, to choose from.",
        ),
    ] = None,
    list_scenarios: Annotated[
        bool, typer.Option("--list", help="List the scenarios of the catalog and exit.")
    ] = False,
    **addresses: str | None,
) -> None:
    """Fly a scenario and write a report.

    Exit status: 0 every flight kept out, completed and met its criteria (or kept out, where the
    scenario requires no more; or every trajectory converged), 1 some did not, 2 bad input, 3 a
    flight entered the keep-out area although every premise of its guard held, 130 interrupted, by
    Ctrl-C or SIGTERM. For a replay: 0 the row of the flight is identical, 1 it is not.
    """
    from scenarios.engine.runner import ExecutorFactory
    from scenarios.engine.task import Limits
    from scenarios.errors import InputError

    try:
        if list_scenarios:
            status = _list()
        else:
            # A replay that is watched takes as long as the flight.
            limits = Limits.given(
                _WATCHED_TIME_LIMIT if any(addresses.values()) else time_limit, memory_limit
            )
            executor_factory = ExecutorFactory(
                jobs=jobs or os.cpu_count() or 1,
                executor=executor,
                scheduler=scheduler,
                limits=limits,
            )
            status = _run(
                name,
                out,
                executor_factory,
                seed,
                overrides or [],
                resume,
                no_report,
                addresses,
                aircraft_dir,
            )
    except InputError as error:
        status = refuse(error)
    except KeyboardInterrupt:
        print("interrupted before the first flight", file=sys.stderr)
        status = INTERRUPTED
    raise typer.Exit(status)


def _list() -> int:
    import tomllib

    from scenarios.scenario.files import catalog

    for name, path in catalog().items():
        print(f"{name:24} {tomllib.loads(path.read_text(encoding='utf-8'))['title']}")
    return MET


@terminated_like_interrupted()
def _run(
    name: str | None,
    out: Path | None,
    executor_factory: "ExecutorFactory",
    seed: int | None,
    overrides: list[str],
    resume: bool,
    no_report: bool,
    addresses: Mapping[str, str | None],
    aircraft_dir: Path | None,
) -> int:
    from scenarios.errors import InputError
    from scenarios.scenario.files import catalog, is_flight, load_study

    if name is None:
        raise InputError(f"no scenario given; give a TOML file or one of: {', '.join(catalog())}")
    if resume and out is None:
        raise InputError("--resume needs --out, the directory of the run to continue")
    if seed is not None:
        overrides = [*overrides, f"seed={seed}"]

    replayed = is_flight(name)
    stem = flight_of(name) if replayed else Path(name).stem
    directory = (
        out
        or Path("runs") / f"{'replay-' if replayed else ''}{stem}-{datetime.now():%Y%m%d-%H%M%S}"
    )
    if replayed and overrides:
        raise InputError(
            f"'{name}' is a flight, which is replayed unchanged; leave out --set and --seed, or"
            " fly its scenario instead"
        )
    viewer = _viewer(addresses, replayed=replayed)
    if aircraft_dir is not None and not replayed:
        from scenarios.scenario.files import aircraft_from

        overrides = aircraft_from(aircraft_dir, name, overrides)
    # Before any slow import: most mistakes in the input are found here.
    scenario = None if replayed else load_study(name, overrides)

    from common.provenance import command_line
    from scenarios.engine.runner import progress_bar

    given = command_line("scenarios.run", sys.argv)
    with progress_bar() as progress:
        if scenario is None:
            from scenarios.engine.runner import fly_study
            from scenarios.studies.replay import Replay

            study = Replay(name, viewer, aircraft_dir=aircraft_dir)
            result = fly_study(
                study,
                directory,
                executor_factory=executor_factory,
                resume=resume,
                progress=progress,
                command=given,
                launched=_print_launch,
            )
        else:
            from scenarios.studies.base import run_study

            result = run_study(
                scenario,
                stem,
                directory,
                executor_factory=executor_factory,
                resume=resume,
                progress=progress,
                overrides=overrides,
                command=given,
                launched=_print_launch,
            )
    for line in result.lines:
        print(line)
    print(f"results: {result.directory}")
    verdict = result.verdict
    if verdict.interrupted:
        counts = verdict.counts
        kept = f"{counts.done} of {counts.planned} {verdict.what} are done and kept"
        left = f"{_are_left(counts.left)} to fly"
        if beside := verdict.comparisons_left:
            left += f"; of the comparisons {_are_left(beside)} to fly"
        print(
            f"interrupted; {kept}, {left}. Continue with:"
            f" {_again(directory, out=out, resume=resume)}",
            file=sys.stderr,
        )
        return verdict.exit_status
    status = _report(directory, changed=result.changed, wanted=not no_report)
    # A flight that contradicts the guard's theorem has priority over a report that could not be
    # built.
    return (
        verdict.exit_status if verdict.exit_status == UNEXPLAINED else status or verdict.exit_status
    )


def _print_launch(launch: "Launch") -> None:
    """Say how many flights there are to fly, and how many are done."""
    comparisons = (
        f", and {launch.comparisons_left} of comparisons" if launch.comparisons_left else ""
    )
    if launch.resumed:
        left = launch.planned - launch.done
        kept = f"; {launch.done} {'is' if launch.done == 1 else 'are'} done and kept"
        print(
            f"{launch.what} left to fly: {left} of {launch.planned}{comparisons}{kept}", flush=True
        )
    else:
        print(f"{launch.what} to fly: {launch.planned}{comparisons}", flush=True)


def _are_left(number: int) -> str:
    return f"{number} {'is' if number == 1 else 'are'} left"


def _again(directory: Path, *, out: Path | None, resume: bool) -> str:
    """Return the command that continues an interrupted run: the user's command, with the run's
    directory and --resume.
    """
    from common.command_line import PROGRAM

    typed = (
        sys.argv[2:]
        if Path(sys.argv[0]).stem == PROGRAM and sys.argv[1:2] == ["run"]
        else sys.argv[1:]
    )
    there = [] if out is not None else ["--out", str(directory)]
    return shlex.join([PROGRAM, "run", *typed, *there, *([] if resume else ["--resume"])])


def _viewer(addresses: Mapping[str, str | None], *, replayed: bool) -> "Viewer | None":
    """Return the program that shows the flight, if one was chosen."""
    from scenarios.errors import InputError

    chosen = {name: address for name, address in addresses.items() if address is not None}
    if not chosen:
        return None
    if len(chosen) > 1 or not replayed:
        raise InputError(
            f"{' and '.join(map(_option, chosen))}: one program at a time shows the replay of a"
            " flight; give RUN_DIR/flights/ID"
        )
    (name, address), *_ = chosen.items()
    try:
        made: Viewer = load_announced(VIEWER, name)(address)
    except PluginError as error:
        raise InputError(str(error)) from None
    return made


def _report(directory: Path, *, changed: bool, wanted: bool) -> int:
    """Write the reports if the user wants them and they are missing or outdated; return the exit
    status.
    """
    reports = [directory / name for name in (REPORT_HTML, REPORT_PDF)]
    there = [] if changed else [path for path in reports if path.is_file()]
    if not changed:
        print("nothing was left to fly: the run was complete")
    if not wanted or there == reports:
        for path in there:
            print(f"report: {path}")
        return MET
    from reports.build import build_reports
    from reports.errors import ReportError

    try:
        for path in build_reports(directory):
            print(f"report: {path}")
    except ReportError as error:
        return refuse(error)
    except OSError as error:
        again = f"plume-flight report {directory}"
        return refuse(
            f"the report cannot be written: {error.strerror}; fix that, then build the report"
            f" with: {again}"
        )
    except KeyboardInterrupt:
        print(
            f"report interrupted; build the report with: plume-flight report {directory}",
            file=sys.stderr,
        )
        return INTERRUPTED
    return MET


def main() -> None:
    """Entry point."""
    # A study runs in several processes; BLAS threads for their small matrices would only slow them
    # down.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    run_command(command, "python -m scenarios.run")


if __name__ == "__main__":
    main()
