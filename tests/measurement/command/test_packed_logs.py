"""Logs that are compressed, and not whole."""

import pytest
from logged_flights import run


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        (
            "cut.csv.gz",
            b"\x1f\x8b\x08",
            "cannot be unpacked: Compressed file ended before the end-of-stream marker was reached",
        ),
        ("no.csv.gz", b"time_s", "cannot be read: Not a gzipped file (b'ti'); give a CSV file"),
        (
            "no.csv.zip",
            b"PK",
            "cannot be unpacked: File is not a zip file; give a whole file, or the CSV file itself",
        ),
        (
            "no.csv.xz",
            b"time_s",
            "cannot be unpacked: Input format not supported by decoder; give a whole file",
        ),
    ],
)
def test_a_compressed_log_that_is_not_whole_is_refused_in_one_line(
    tmp_path, capsys, name, content, words
):
    (tmp_path / name).write_bytes(content)
    assert run(tmp_path / name, config=False) == 2
    assert capsys.readouterr().err.startswith(f"error: '{tmp_path / name}' {words}")
