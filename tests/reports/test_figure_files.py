"""Figures of a printed report, drawn by one process or by several."""

import os

import numpy as np
from matplotlib.figure import Figure

from reports.document.chart import Chart, Line, Panel
from reports.render import figure_files
from reports.render.figure_files import write_figures

COUNT = 4
"""Charts that are drawn."""


def a_chart(name):
    x = np.array([1.0, 2.0])
    line = Line(x=x, y=x, label="curve", colour="blue")
    panel = Panel(x_label="Time [s]", y_label="Distance [m]", lines=[line])
    return Chart(name=name, caption=f"Caption of {name}.", panels=[panel])


def drawn_by(folder, processes, monkeypatch):
    """Draw charts by so many processes; return each file's content."""
    monkeypatch.setattr(figure_files.os, "cpu_count", lambda: processes)
    # Enough for two processes, where a report would need twelve.
    monkeypatch.setattr(figure_files, "_FIGURES_PER_PROCESS", COUNT // 2)
    folder.mkdir()
    write_figures({f"{i}.svg": a_chart(f"chart{i}") for i in range(COUNT)}, folder)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_they_do_not_depend_on_the_number_of_processes(tmp_path, monkeypatch):
    alone = drawn_by(tmp_path / "alone", 1, monkeypatch)
    assert len(alone) == COUNT
    assert drawn_by(tmp_path / "together", 2, monkeypatch) == alone


def test_several_processes_draw_where_there_is_enough_to_draw(tmp_path, monkeypatch):
    def drawn(chart):
        (tmp_path / str(os.getpid())).touch()
        return Figure(figsize=(1.0, 1.0))

    monkeypatch.setattr(figure_files, "draw", drawn)
    drawn_by(tmp_path / "together", 2, monkeypatch)
    drawers = {path.name for path in tmp_path.iterdir() if path.is_file()}
    assert drawers
    assert str(os.getpid()) not in drawers
