"""A simulated vehicle that is served in this process, and a companion's command against it."""

import math
import socket
import tempfile
import threading
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

from extensions.companion import command
from extensions.companion.plane import PlaneMode
from extensions.companion.ports import Port, opened
from extensions.companion.simulation import COMPONENT, Server, Simulation, send_readings
from scenarios.engine.run_directory import RunDirectory
from scenarios.studies.base import SingleFlight
from tests.in_process import run_command

HOME = (1.0, 0.2)


@dataclass
class Served:
    """A vehicle under way.

    Attributes
    ----------
    url : where it is
    simulation : the vehicle itself
    received : messages that have come, each with the vehicle's time
    failures : exceptions of its thread
    """

    url: str
    simulation: Simulation
    received: list[tuple[float, Any]] = field(default_factory=list)
    failures: list[Exception] = field(default_factory=list)

    def count(self, kind, *, after=0.0):
        return sum(at > after and message.get_type() == kind for at, message in self.received)


def free_port(kind=socket.SOCK_STREAM):
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextmanager
def served(scenario, *settings, lockstep=True, scheme="tcp", parameters=None, sniffer=None,
           log=None, change=lambda message: message, at_step=lambda _: None):  # fmt: skip
    """Serve the vehicle of a flight.

    Parameters
    ----------
    scenario, settings : the flight, the only one of the scenario
    change : of each message that it sends; None for none
    at_step : called before each step
    sniffer : where the readings of the scenario's sniffer are sent, or none
    log : telemetry log of both directions, or none
    """
    single = command._flight(SingleFlight, scenario, list(settings), None)
    with tempfile.TemporaryDirectory() as folder:
        work = single.work(RunDirectory(Path(folder)))
        request = work.request(single.task)
        simulation = Simulation(work.plan(request), work.setup_of(request), home=HOME,
                                mode=PlaneMode.GUIDED, parameters=parameters)  # fmt: skip
        readings = sniffer and opened("--sniffer", sniffer, listening=False)
        if readings:
            send_readings(simulation, request, work.plan(request), readings)
    kind = socket.SOCK_DGRAM if scheme == "udp" else socket.SOCK_STREAM
    url = f"{scheme}://127.0.0.1:{free_port(kind)}"
    port = Port(opened("--listen", url, listening=True), system=1, component=COMPONENT, log=log)
    found = Served(url, simulation)
    send, receive, step = port.send, port.receive, simulation.step

    def send_changed(message, peer=None):
        if message.get_type() != "SYSTEM_TIME":
            message = change(message)
        if message is not None:
            send(message, peer)

    def receive_noted(timeout):
        come = receive(timeout)
        found.received += [(simulation.time, message) for _, message in come]
        return come

    def stepped():
        at_step(simulation)
        step()

    port.send, port.receive, simulation.step = send_changed, receive_noted, stepped
    server = Server(simulation, port, lockstep=lockstep)

    def serve():
        try:
            server.run(math.inf)
        except Exception as error:  # noqa: BLE001 - the test looks at it
            found.failures.append(error)

    thread = threading.Thread(target=serve)
    thread.start()
    with port:
        try:
            yield found
        finally:
            server.stopping.set()
            thread.join()
            if readings:
                readings.close()
    assert not found.failures


def companion(vehicle, scenario, out, *options, settings=()):
    """Run ``plume-flight companion`` against a vehicle, with a tenth of its wait for rivals."""
    keys = [word for key in settings for word in ("--set", key)]
    with mock.patch("extensions.companion.flight.RIVALS_SEEN_IN", 0.1):
        return run_command("scenarios.cli.main", "companion", scenario, "--connect", vehicle.url,
                           "--out", out, "--wait", "20", *options, *keys)  # fmt: skip
