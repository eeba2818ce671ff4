"""What a notebook shows of a scenario, a flight or a run."""

import base64
import html
import io
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DPI = 90


def table(rows: Iterable[Sequence[object]]) -> str:
    """Return rows as a table of HTML; whatever stands in a cell is text."""
    body = "".join(
        f"<tr>{''.join(f'<td>{html.escape(str(cell))}</td>' for cell in row)}</tr>" for row in rows
    )
    return f"<table>{body}</table>"


def picture(figure: "Figure", alternative: str) -> str:
    """Return a figure as an image inside the page, with the text that stands for it."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_DPI)
    content = base64.b64encode(buffer.getvalue()).decode()
    return f'<img alt="{html.escape(alternative)}" src="data:image/png;base64,{content}">'
