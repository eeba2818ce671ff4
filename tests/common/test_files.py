"""Files in JSON."""

import json

import numpy as np
import pytest

from common.files import json_text


def test_numbers_of_numpys_are_written_as_numbers():
    # A shape or a plume of a user's own may answer in them.
    text = json_text(
        {
            "speed": np.float32(0.5),
            "count": np.int64(3),
            "whole": np.bool_(True),
            "array": np.array(1.5),
        },
        indent=1,
    )
    assert json.loads(text) == {"speed": 0.5, "count": 3, "whole": True, "array": 1.5}


def test_what_json_cannot_express_is_an_error():
    with pytest.raises(ValueError, match="JSON compliant"):
        json_text({"speed": np.float32(np.nan)}, indent=1)
    with pytest.raises(TypeError, match="JSON cannot express set"):
        json_text({"speed": {1.0}}, indent=1)
