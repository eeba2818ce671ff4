"""What a column of a run's tables is: its name in tables and on axes, its unit, its meaning.

Whoever fills a column declares it once, as a mapping from its name to a ``Column``; a user's
instrument or study does it in the same way. A run keeps the columns of its tables in
``columns.json``, and everything that shows a column reads that.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import KW_ONLY, asdict, dataclass, fields, replace
from typing import Any

_UNITS = {
    "_per_hour": "1/h",
    "_per_m": "1/m",
    "_per_m2": "1/m2",
    "_per_m_s": "1/(m s)",
    "_per_s": "1/s",
    "_s_per_minute": "s/min",
    "_per_minute": "1/min",
    "_percent": "% m/m",
    "_deg_s": "deg/s",
    "_m2_s2": "m2/s2",
    "_rad_s": "rad/s",
    "_mps": "m/s",
    "_mps2": "m/s2",
    "_deg": "deg",
    "_rad": "rad",
    "_ppm_s": "ppm s",
    "_ppm": "ppm",
    "_ppb": "ppb",
    "_hz": "Hz",
    "_c": "degC",
    "_m": "m",
    "_s": "s",
    "_utc": "UTC",
}
"""Units by the ends of names; the longest end that fits counts. What is in per cent is sulphur in
fuel, by mass.
"""

_ENDS = sorted(_UNITS, key=len, reverse=True)

DIMENSIONLESS = "1"
"""Unit of a figure without one."""

_WORSE, _KINDS = ("", "higher", "lower", "off zero"), ("number", "text", "truth", "any")


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table of a run.

    Attributes
    ----------
    meaning : what it is, in a sentence without a full stop
    title : its name in tables and on axes; that of the column in words, if none is given
    symbol : its symbol in formulas, which stands for the title at the head of a table
    unit : as shown; what the column's name ends in, if none is given, and ``DIMENSIONLESS`` where
        that is no unit
    digits : after the point
    worse : "higher" or "lower", where that is to a flight's disadvantage; "off zero" of an error
        with a sign
    adds_up : whether the sum over flights means something, as of counts and times
    scale : from the recorded value to ``unit``
    missing : what a flight without it is
    kind : "number", "text" or "truth"; "any" where it differs from run to run
    part : the user's instrument or study that fills it, or "sniffer"; empty for the flight's own

    Raises
    ------
    ValueError : one of them is of another type or value
    """

    meaning: str = ""
    _: KW_ONLY
    title: str = ""
    symbol: str = ""
    unit: str = ""
    digits: int = 2
    worse: str = ""
    adds_up: bool = False
    scale: float = 1.0
    missing: str = "without"
    kind: str = "number"
    part: str = ""

    def __post_init__(self) -> None:
        for name in ("meaning", "title", "symbol", "unit", "missing", "part"):
            if not isinstance(value := getattr(self, name), str) or "\n" in value:
                raise ValueError(f"{name} of a column is {value!r}; give text of one line")
        if type(self.digits) is not int or not 0 <= self.digits <= 12:
            raise ValueError(f"digits of a column is {self.digits!r}; give 0 to 12")
        if not (isinstance(self.scale, int | float) and math.isfinite(self.scale) and self.scale):
            raise ValueError(f"scale of a column is {self.scale!r}; give a number other than 0")
        for name, known in (("worse", _WORSE), ("kind", _KINDS), ("adds_up", (True, False))):
            if (value := getattr(self, name)) not in known:
                words = ", ".join(map(repr, known))
                raise ValueError(f"{name} of a column is {value!r}; give one of {words}")

    @property
    def bracket(self) -> str:
        """Unit in brackets after a space; empty without a unit."""
        return f" [{self.unit}]" if self.after else ""

    @property
    def after(self) -> str:
        """Unit after a value and a space; empty without a unit."""
        return "" if self.unit in ("", DIMENSIONLESS) else f" {self.unit}"

    @property
    def head(self) -> str:
        """What stands over it in a table: its symbol or else its title, and the unit if any."""
        return f"{self.symbol or self.title}{self.bracket}"

    @property
    def row(self) -> str:
        """What stands before it in a table with a row for it: its title, and the unit if any."""
        return f"{self.title}{self.bracket}"

    @property
    def label(self) -> str:
        """What an axis says: title and unit, "-" without one."""
        return f"{self.title}{self.bracket or ' [-]'}"

    def text(self, value: float | None) -> str:
        """Return a recorded value in digits and in its unit, and a dash if there is none."""
        if value is None or not math.isfinite(value):
            return "–"
        return f"{self.scale * value:.{self.digits}f}".replace("-", "−")


Table = Mapping[str, Column]
"""The columns of a table by their names, in order."""

Declared = Mapping[str, Column | str] | Iterable[str]
"""Columns as they are declared: each by a ``Column`` or by its meaning, or all by names alone."""


def unit_of(name: str) -> str:
    """Return the unit that a name ends in, ``DIMENSIONLESS`` if it is none."""
    return next((_UNITS[end] for end in _ENDS if name.endswith(end)), DIMENSIONLESS)


def without_unit(name: str) -> str:
    """Return a name without the unit that it ends in."""
    return next((name.removesuffix(end) for end in _ENDS if name.endswith(end)), name)


def described(declared: Declared, *, part: str = "") -> dict[str, Column]:
    """Return columns, each with a title and a unit, and with the part that fills it.

    Raises
    ------
    ValueError : a column is declared by something else than a ``Column`` or text
    """
    given = declared if isinstance(declared, Mapping) else dict.fromkeys(declared, "")
    return {name: _described(name, column, part) for name, column in given.items()}


def _described(name: str, column: Column | str, part: str) -> Column:
    if isinstance(column, str):
        column = Column(column)
    if not isinstance(column, Column):
        raise ValueError(
            f"column '{name}' is declared by {column!r}; give a common.columns.Column, or text"
        )
    # A key of a scenario, as in draws.csv, has the unit of its last word.
    last = name.rpartition(".")[2]
    words = without_unit(last).strip("_").replace("_", " ") or last
    return replace(
        column,
        title=column.title or words[:1].upper() + words[1:],
        unit=column.unit or unit_of(last),
        part=column.part or part,
    )


def column_of(tables: Mapping[str, Table], table: str, name: str) -> Column:
    """Return a column of a table, with title and unit by its name where none are declared."""
    return tables.get(table, {}).get(name) or _described(name, "", "")


_ALWAYS = ("title", "symbol", "unit", "digits", "meaning", "worse")
"""Fields that are written of every column; others where they differ from their default."""

_DEFAULTS = {field.name: field.default for field in fields(Column)}


def to_json(tables: Mapping[str, Table]) -> dict[str, dict[str, dict[str, Any]]]:
    """Return the content of ``columns.json``: tables by file, columns by name."""
    return {
        table: {
            name: {
                key: value
                for key, value in asdict(column).items()
                if key in _ALWAYS or value != _DEFAULTS[key]
            }
            for name, column in columns.items()
        }
        for table, columns in tables.items()
    }


def from_json(document: Mapping[str, Any]) -> dict[str, dict[str, Column]]:
    """Return the tables that ``columns.json`` holds; fields of later versions are left out.

    Raises
    ------
    ValueError, TypeError, AttributeError : it holds something else
    """
    return {
        table: {
            name: Column(**{key: value for key, value in of.items() if key in _DEFAULTS})
            for name, of in columns.items()
        }
        for table, columns in document.items()
    }
