from dataclasses import FrozenInstanceError

import pytest

from nrs_design.switched.system import Time
from tests.support import family


def test_order_is_the_number_of_states():
    assert family([[1, 2, 3], [4, 5, 6], [7, 8, 9]]).order == 3


def test_times_by_name():
    assert [str(time) for time in Time] == ["continuous", "discrete"]


def test_frozen():
    system = family([[1]])
    with pytest.raises(FrozenInstanceError):
        system.modes = ()
    with pytest.raises(FrozenInstanceError):
        system.modes[0].A = None
