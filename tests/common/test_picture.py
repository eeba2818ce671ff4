"""Pictures that a user gives are known by their content; all else is refused in one line."""

import io

import pytest
from PIL import Image

from common.picture import PictureError, read_picture

SVG = (
    b'<svg xmlns="http://www.w3.org/2000/svg" width="4" height="2">'
    b'<rect width="4" height="2"/></svg>'
)


def drawn(kind):
    buffer = io.BytesIO()
    Image.new("RGB", (40, 20), "navy").save(buffer, kind)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("content", "media_type", "suffix"),
    [
        (drawn("PNG"), "image/png", ".png"),
        (drawn("JPEG"), "image/jpeg", ".jpg"),
        (SVG, "image/svg+xml", ".svg"),
    ],
)
def test_the_content_says_what_kind_of_picture_a_file_is_and_its_name_does_not(
    content, media_type, suffix, tmp_path
):
    path = tmp_path / "logo.dat"
    path.write_bytes(content)
    picture = read_picture(path)
    assert (picture.content, picture.media_type, picture.suffix) == (content, media_type, suffix)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is not a picture; give a whole PNG"),
        (drawn("PNG")[:60], "is not a picture"),
        (b"<html/>", "is not a picture"),
        (b'<?xml version="1.0" encoding="none-such"?>' + SVG, "is not a picture"),
        (
            SVG.replace(b"<rect", b'<image href="https://example.org/a.png"/><rect'),
            "is not a picture",
        ),
    ],
)
def test_what_is_no_picture_is_refused_in_one_line_that_names_the_file_alone(
    content, said, tmp_path
):
    path = tmp_path / "logo.png"
    path.write_bytes(content)
    with pytest.raises(PictureError) as refused:
        read_picture(path)
    assert str(refused.value).startswith("'logo.png' ")
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
