"""Description of the columns of a run's tables: titles, units and meanings.

The code that fills a column declares it once, by name, with a ``Column``. A user's instrument or
study declares its columns in the same way. A run keeps its columns in ``columns.json``, which
reports and exports read.
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
    "_g_kg": "g/kg",
    "_1e15_kg": "10^15/kg",
    "_hz": "Hz",
    "_c": "degC",
    "_m": "m",
    "_s": "s",
    "_utc": "UTC",
}
"""Units by suffixes of names; the longest matching suffix counts.

Per cent is used for sulphur in fuel, by mass.
"""

_ENDS = sorted(_UNITS, key=len, reverse=True)

DIMENSIONLESS = "1"
"""Unit of a dimensionless figure."""

_WORSE, _KINDS = ("", "higher", "lower", "off zero"), ("number", "text", "truth", "any")


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a run's table.

    Attributes
    ----------
    meaning : what the column contains, in a sentence without a full stop
    title : name in tables and on axes; by default the column's name in words
    symbol : symbol in formulas, which replaces the title at the head of a table
    unit : unit as shown; by default the suffix of the column's name, or ``DIMENSIONLESS``
    digits : number of digits after the decimal point
    worse : "higher" or "lower", whichever is to a flight's disadvantage; "off zero" for a signed
        error
    adds_up : whether the sum over flights has a meaning, such as a sum of counts or times
    scale : factor from the recorded value to ``unit``
    missing : description of a flight without a value
    kind : "number", "text" or "truth"; "any" if it differs from run to run
    part : user's instrument or study that fills the column, or "sniffer"; empty for the flight

    Raises
    ------
    ValueError : an attribute has a wrong type or value
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
        """Heading of the column in a table: symbol or title, and the unit if there is one."""
        return f"{self.symbol or self.title}{self.bracket}"

    @property
    def row(self) -> str:
        """Heading of the column's row in a table: title, and the unit if there is one."""
        return f"{self.title}{self.bracket}"

    @property
    def label(self) -> str:
        """Label of an axis: title and unit, or "-" without a unit."""
        return f"{self.title}{self.bracket or ' [-]'}"

    def text(self, value: float | None) -> str:
        """Return a recorded value as text in its unit, or a dash if there is no value."""
        if value is None or not math.isfinite(value):
            return "–"
        return f"{self.scale * value:.{self.digits}f}".replace("-", "−")


Table = Mapping[str, Column]
"""The columns of a table by name, in order."""

Declared = Mapping[str, Column | str] | Iterable[str]
"""Declared columns: a ``Column`` or a meaning for each name, or names alone."""


def unit_of(name: str) -> str:
    """Return the unit in a name's suffix, or ``DIMENSIONLESS``."""
    return next((_UNITS[end] for end in _ENDS if name.endswith(end)), DIMENSIONLESS)


def without_unit(name: str) -> str:
    """Return a name without the suffix of its unit."""
    return next((name.removesuffix(end) for end in _ENDS if name.endswith(end)), name)


def described(declared: Declared, *, part: str = "") -> dict[str, Column]:
    """Return declared columns with their title, unit and part filled in.

    Raises
    ------
    ValueError : a column is declared by something other than a ``Column`` or text
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
    # In a dotted key of a scenario, as in draws.csv, the last word has the unit.
    last = name.rpartition(".")[2]
    words = without_unit(last).strip("_").replace("_", " ") or last
    return replace(
        column,
        title=column.title or words[:1].upper() + words[1:],
        unit=column.unit or unit_of(last),
        part=column.part or part,
    )


def column_of(tables: Mapping[str, Table], table: str, name: str) -> Column:
    """Return a column of a table; an undeclared column gets title and unit from its name."""
    return tables.get(table, {}).get(name) or _described(name, "", "")


_ALWAYS = ("title", "symbol", "unit", "digits", "meaning", "worse")
"""Fields that are always written; other fields only if they differ from their default."""

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
    """Return the tables in ``columns.json``; unknown fields of later versions are ignored.

    Raises
    ------
    ValueError, TypeError, AttributeError : the document does not have this form
    """
    return {
        table: {
            name: Column(**{key: value for key, value in of.items() if key in _DEFAULTS})
            for name, of in columns.items()
        }
        for table, columns in document.items()
    }
