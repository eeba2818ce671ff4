"""What every command line does with its output and with signals, and parts that do not load."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
from typing import Annotated

import pytest
import typer

from common.command_line import run_command
from common.interrupt import follow_parent, terminated_like_interrupted
from common.registry import Registry

PROGRAM = """
import sys
from common.command_line import run_command

def command():
    for line in range(100_000 if {long} else 1):
        try:
            print(line, file=sys.{stream})
        except OSError:
            print("a file that cannot be written", file=sys.{other})

run_command(command, "program")
"""


@pytest.mark.parametrize("long", [True, False])
@pytest.mark.parametrize(("stream", "other"), [("stdout", "stderr"), ("stderr", "stdout")])
def test_a_command_whose_reader_is_gone_ends_without_a_word(stream, other, long):
    program = PROGRAM.format(stream=stream, other=other, long=long)
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as running:
        getattr(running, stream).close()
        said = getattr(running, other).read()
    assert said == b""
    # As a shell says of a program that SIGPIPE ended: 128 + 13.
    assert running.returncode == 141


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["--jobs", "0"], "--jobs is 0; it must be greater than or equal to 1"),
        (["--jobs=two"], "--jobs is two; it must be a valid integer"),
        (["--job", "2"], "No such option: --job (Possible options: --jobs)"),
    ],
)
def test_an_option_that_is_out_of_range_is_refused_with_its_value(
    given, words, monkeypatch, capsys
):
    def command(jobs: Annotated[int, typer.Option(min=1)] = 1) -> None:
        raise AssertionError(jobs)

    monkeypatch.setattr(sys, "argv", ["program", *given])
    with pytest.raises(SystemExit) as ended:
        run_command(command, "program")
    said = f"error: {words}; see program --help\n"
    assert (ended.value.code, capsys.readouterr().err) == (2, said)


@pytest.fixture(autouse=True)
def unchanged():
    """Leave the handling of SIGTERM as it was."""
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


def test_sigterm_interrupts_within_the_context_alone():
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with pytest.raises(KeyboardInterrupt), terminated_like_interrupted():
        signal.raise_signal(signal.SIGTERM)
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def _follow(ready):
    follow_parent()
    ready.set()
    threading.Event().wait()


def test_sigterm_ends_a_process_of_a_command_that_handles_it():
    # A forked process inherits the handler: with it, it would print an interrupt of its own.
    context = multiprocessing.get_context("fork")
    ready = context.Event()
    with terminated_like_interrupted():
        process = context.Process(target=_follow, args=(ready,), daemon=True)
        process.start()
        assert ready.wait(10.0)
        os.kill(process.pid, signal.SIGTERM)
        process.join(10.0)
    assert process.exitcode == -signal.SIGTERM


def test_a_module_that_does_not_load_hides_no_part_at_the_next_call(tmp_path, monkeypatch):
    package = tmp_path / "parts_of_a_test"
    package.mkdir()
    for name, text in (("__init__", ""), ("begins", "0 / 0"), ("ends", "")):
        (package / f"{name}.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    registry = Registry("part", folder=package.name)
    try:
        # Not known by halves, without a word of it.
        for _ in range(2):
            with pytest.raises(ZeroDivisionError):
                registry.names()
        (package / "begins.py").unlink()
        assert registry.names() == []
        assert f"{package.name}.ends" in sys.modules
    finally:
        for name in [name for name in sys.modules if name.partition(".")[0] == package.name]:
            del sys.modules[name]
