"""Links from pages to the repository: a link to a file becomes a download, a link to a folder
becomes its name, and a link to a page leads to that page.
"""

import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

_LINK = re.compile(r"\[(?P<text>[^\]]+)\]\((?P<target>(?:\.\./)+[^)#\s]+)(?P<part>#[^)\s]+)?\)")

PAGES = {"gnc/EQUATIONS.md": "equations.md", "CHANGELOG.md": "changelog.md"}
"""Files of the repository that are pages of the documentation."""

_EXTENSION = re.compile(r"extensions/(?P<name>\w+)/page\.md")


def page_of(path: str) -> str | None:
    """Return the page of the documentation that a file of the repository is, or None."""
    extension = _EXTENSION.fullmatch(path)
    return f"generated/extensions/{extension['name']}.md" if extension else PAGES.get(path)


def extension_pages(root: Path) -> dict[str, str]:
    """Return the pages of the extensions by their names, with links as in the documentation.

    Parameters
    ----------
    root : of the documentation
    """
    found = {}
    for path in sorted((root.parent / "extensions").glob("*/page.md")):
        folder = path.parent

        def link(found: re.Match[str], folder: Path = folder) -> str:
            target = (folder / found["target"]).resolve()
            if target.is_relative_to(root):
                there = f"/{target.relative_to(root).as_posix()}"
            else:
                there = f"../../../{target.relative_to(root.parent).as_posix()}"
            return f"[{found['text']}]({there}{found['part'] or ''})"

        found[folder.name] = _LINK.sub(link, path.read_text(encoding="utf-8"))
    return found


def with_links(text: str, folder: Path, root: Path) -> str:
    """Return a page whose links out of the documentation can be followed in it.

    Parameters
    ----------
    text : of the page
    folder : in which the page is
    root : of the documentation
    """

    def link(found: re.Match[str]) -> str:
        target = (folder / found["target"]).resolve()
        if target.is_dir() and not target.is_relative_to(root):
            return found["text"]
        page = (
            page_of(target.relative_to(root.parent).as_posix())
            if target.is_relative_to(root.parent)
            else None
        )
        return f"[{found['text']}](/{page}{found['part'] or ''})" if page else found[0]

    return _LINK.sub(link, text)


def setup(app: "Sphinx") -> dict[str, bool]:
    """Let Sphinx convert the links of every page in this way."""

    def read(app: "Sphinx", name: str, source: list[str]) -> None:
        root = Path(app.srcdir).resolve()
        source[0] = with_links(source[0], (root / name).parent, root)

    app.connect("source-read", read)
    return {"parallel_read_safe": True}
