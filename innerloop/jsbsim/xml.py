"""JSBSim's XML as far as the autopilot needs it: expressions, tables and components."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def number(value: float) -> str:
    """Return a constant."""
    return f"<v>{value:.9g}</v>"


def read(name: str) -> str:
    """Return the value of a property."""
    return f"<p>{name}</p>"


def operation(tag: str, *operands: str) -> str:
    """Return a JSBSim operation such as ``sum`` or ``product`` over operands."""
    return f"<{tag}>{''.join(operands)}</{tag}>"


def total(*operands: str) -> str:
    """Return the sum."""
    return operation("sum", *operands)


def times(*operands: str) -> str:
    """Return the product."""
    return operation("product", *operands)


def minus(first: str, *others: str) -> str:
    """Return the first less the others."""
    return operation("difference", first, *others)


def clipped(value: str, low: float, high: float) -> str:
    """Return ``value`` kept within ``low`` and ``high``."""
    return operation("min", operation("max", value, number(low)), number(high))


def within(value: str, limit: float) -> str:
    """Return 1 while ``value`` lies within plus and minus ``limit``, otherwise 0."""
    return operation("le", operation("abs", value), number(limit))


def table_1d(at: str, rows: Sequence[float], values: Sequence[float]) -> str:
    """Return linear interpolation of ``values`` over property ``at``, constant past the ends."""
    data = "\n".join(f"{row:.9g} {value:.9g}" for row, value in zip(rows, values, strict=True))
    return f'<table><independentVar lookup="row">{at}</independentVar><tableData>\n{data}\n</tableData></table>'


def table_2d(
    row_at: str, column_at: str, rows: Sequence[float], columns: Sequence[float], values: Array
) -> str:
    """Return bilinear interpolation of ``values``, shape (rows, columns), constant past the edges."""
    head = " ".join(f"{column:.9g}" for column in columns)
    body = "\n".join(
        f"{row:.9g} " + " ".join(f"{x:.9g}" for x in line)
        for row, line in zip(rows, values, strict=True)
    )
    return (
        f'<table><independentVar lookup="row">{row_at}</independentVar>'
        f'<independentVar lookup="column">{column_at}</independentVar><tableData>\n{head}\n{body}\n</tableData></table>'
    )


def function(name: str, expression: str, outputs: Sequence[str] = ()) -> str:
    """Return a component that writes an expression to property ``name``, and to ``outputs`` as
    well.
    """
    extra = "".join(f"<output>{output}</output>" for output in outputs)
    return f'<fcs_function name="{name}"><function>{expression}</function>{extra}</fcs_function>'


def channel(name: str, period: int, components: Sequence[str]) -> str:
    """Return a channel whose components run every ``period`` time steps."""
    return f'<channel name="{name}" execrate="{period}">\n' + "\n".join(components) + "\n</channel>"


def integrator(name: str, source: str, reset: str) -> str:
    """Return a component that integrates property ``source`` by the trapezoidal rule, held at 0
    while ``reset`` is negative.

    JSBSim's own ``<integrator>`` can be held but not reset, so this is a ``<pid>`` with its
    integral alone.
    """
    gains = '<kp>0</kp><ki type="trap">1</ki><kd>0</kd>'
    return f'<pid name="{name}"><input>{source}</input>{gains}<trigger>{reset}</trigger></pid>'
