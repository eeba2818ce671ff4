"""Read a user's picture, such as the logo of a report."""

import base64
import hashlib
import io
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

BYTES_MAX = 1_000_000
"""Largest size of a picture's file [bytes]: every report contains the picture."""

_SVG = "{http://www.w3.org/2000/svg}svg"
"""Root element of an SVG document."""

_SUFFIXES = {"image/png": ".png", "image/jpeg": ".jpg", "image/svg+xml": ".svg"}
"""Media types that reports can show, with file suffixes."""


class PictureError(ValueError):
    """A file is not a usable picture; the message is one line."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture: content of the file, and media type."""

    content: bytes
    media_type: str

    @property
    def suffix(self) -> str:
        """Suffix of a file with this picture."""
        return _SUFFIXES[self.media_type]

    @property
    def sha256(self) -> str:
        """Hash of the file."""
        return hashlib.sha256(self.content).hexdigest()

    @property
    def data_uri(self) -> str:
        """The picture as a ``data:`` address, for the HTML report."""
        return f"data:{self.media_type};base64,{base64.b64encode(self.content).decode('ascii')}"


def read_picture(path: Path) -> Picture:
    """Read a PNG, JPEG or SVG file; the content, not the name, decides the type.

    Raises
    ------
    PictureError : the file cannot be read, is too large, or is not a picture
    """
    try:
        content = path.read_bytes()
    except (OSError, ValueError) as error:
        raise PictureError(
            f"'{path.name}' cannot be read ({getattr(error, 'strerror', error)}); "
            "give a PNG, JPEG or SVG"
        ) from None
    if len(content) > BYTES_MAX:
        raise PictureError(
            f"'{path.name}' has {len(content) / 1e6:.1f} MB; at most {BYTES_MAX / 1e6:g} MB: "
            "give a smaller picture"
        )
    media_type = _media_type(content)
    if media_type is None:
        raise PictureError(f"'{path.name}' is not a picture; give a whole PNG, JPEG or SVG file")
    return Picture(content, media_type)


def _media_type(content: bytes) -> str | None:
    """Return the media type of a picture, or None for other content."""
    from PIL import Image

    try:
        with Image.open(io.BytesIO(content), formats=("PNG", "JPEG")) as image:
            image.load()
            return f"image/{str(image.format).lower()}"
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        pass
    # An unknown encoding raises LookupError or ValueError.
    try:
        is_svg = ET.fromstring(content).tag == _SVG and _can_be_printed(content)
    except (ET.ParseError, LookupError, ValueError):
        return None
    return "image/svg+xml" if is_svg else None


def _can_be_printed(svg: bytes) -> bool:
    """Return whether typst can draw an SVG, which needs a size and must not have links."""
    import typst

    try:
        typst.compile(
            b'#image(bytes(sys.inputs.svg), format: "svg", width: 20pt)',
            sys_inputs={"svg": svg.decode()},
        )
    except typst.TypstError:
        return False
    return True
