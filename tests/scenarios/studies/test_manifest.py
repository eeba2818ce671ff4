"""The files that a run takes parts from: all are found and hashed, and one that is gone is refused
in one line.
"""

import pytest

from common.registry import file_hash
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from scenarios.studies.manifest import plugins
from tests.scenarios.plugin_files import INSTRUMENT, LAW


def written(folder, text):
    path = folder / "own.toml"
    path.write_text(f'title = "own"\n{text}', encoding="utf-8")
    return load_study(str(path))


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize(
    ("key", "name", "words"),
    [
        ("reference.shape", "gone.py:X", "gone.py: cannot be read: No such file or directory"),
        ("wind.table", "gone.csv", "gone.csv: cannot be read: No such file or directory"),
        ("aircraft", "gone/x", "gone/x': there is no such directory"),
    ],
)
def test_a_part_whose_file_is_gone_is_refused_in_one_line(tmp_path, key, name, words, resume):
    scenario = written(tmp_path, f'{key} = "{name}"\n')
    with pytest.raises(InputError) as refused:
        run_study(scenario, "own", tmp_path / "run", resume=resume)
    message = str(refused.value)
    assert message.startswith(f"{key}: ")
    assert words in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "part", "code"),
    [
        (
            '[[draws]]\nkey = "payload.instruments"\nchoice = [[], ["own.py:Sniffer"]]\n',
            "own.py:Sniffer",
            INSTRUMENT,
        ),
        (
            'following.margin_law = "own.py:Pursuit"\nturbulence.level = "light"\n',
            "own.py:Pursuit",
            LAW,
        ),
        (
            'turbulence.level = "light"\n[[draws]]\nkey = "following.margin_law"\nchoice = ["own.py:Pursuit"]\n',
            "own.py:Pursuit",
            LAW,
        ),
        ('study = "own.py:Closest"\n', "own.py:Closest", "class Closest: ...\n"),
    ],
)
def test_every_file_that_a_part_comes_from_is_hashed(tmp_path, text, part, code):
    (tmp_path / "own.py").write_text(code, encoding="utf-8")
    name = str(tmp_path / part)
    assert plugins([written(tmp_path, text)]) == {name: file_hash(name)}
