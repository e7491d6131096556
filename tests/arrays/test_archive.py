"""Archives that can be told from those of other programs."""

import io

import numpy as np

from nrs_design.arrays.archive import to_archive
from nrs_design.output import ARCHIVE


def test_arrays_come_back_and_say_whose_they_are():
    content = to_archive("another archive", {"a": np.arange(6).reshape(2, 3)})
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        assert str(arrays["about"]) == "another archive"
        assert arrays["a"].tolist() == [[0, 1, 2], [3, 4, 5]]
    assert not content.startswith(ARCHIVE)
