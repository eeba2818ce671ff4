"""Writes the pages and the pictures that are made from the program before Sphinx reads them."""

from pathlib import Path
from typing import TYPE_CHECKING

from reference_pages.columns import columns_page
from reference_pages.commands import commands_page
from reference_pages.frames import frames_svg
from reference_pages.house import house_svg
from reference_pages.keys import keys_page
from reference_pages.modules import module_pages
from repository_links import extension_pages

if TYPE_CHECKING:
    from sphinx.application import Sphinx

FOLDER = "generated"
"""Where they are written, in the folder of the documentation; it is not committed."""


def pages() -> dict[str, str]:
    """Return the texts of the files by their names."""
    modules = dict(module_pages())
    extensions = extension_pages(Path(__file__).resolve().parents[1])
    return {
        "keys.md": keys_page(),
        "columns.md": columns_page(),
        "command_line.md": commands_page(),
        "frames.svg": frames_svg(),
        "house.svg": house_svg(),
        "modules.md": _contents("Modules", [f"modules/{name}" for name in modules]),
        **{f"modules/{name}.md": text for name, text in modules.items()},
        "extensions.md": _contents("Extensions", [f"extensions/{name}" for name in extensions]),
        **{f"extensions/{name}.md": text for name, text in extensions.items()},
    }


def _contents(title: str, pages: list[str]) -> str:
    """Return a page that lists others."""
    return "\n".join([f"# {title}", "", "```{toctree}", ":maxdepth: 1", "", *pages, "```", ""])


def _write(app: "Sphinx") -> None:
    folder = Path(app.srcdir) / FOLDER
    made = pages()
    for path in folder.rglob("*.md"):
        if path.relative_to(folder).as_posix() not in made:
            path.unlink()
    for name, text in made.items():
        path = folder / name
        # An unchanged page is not read again.
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")


def setup(app: "Sphinx") -> dict[str, bool]:
    """Write the pages when the build begins."""
    app.connect("builder-inited", _write)
    return {"parallel_read_safe": True}
