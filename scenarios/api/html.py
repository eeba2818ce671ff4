"""HTML of tables and figures for notebooks."""

import base64
import html
import io
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DPI = 90


def table(rows: Iterable[Sequence[object]]) -> str:
    """Return rows as an HTML table; cells are escaped."""
    body = "".join(
        f"<tr>{''.join(f'<td>{html.escape(str(cell))}</td>' for cell in row)}</tr>" for row in rows
    )
    return f"<table>{body}</table>"


def picture(figure: "Figure", alternative: str) -> str:
    """Return a figure as an HTML image with its alternative text."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_DPI)
    content = base64.b64encode(buffer.getvalue()).decode()
    return f'<img alt="{html.escape(alternative)}" src="data:image/png;base64,{content}">'
