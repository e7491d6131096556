from dataclasses import FrozenInstanceError
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.switched.system import Switching, Time
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


def test_dwell_time_of_numpy_becomes_one_of_python():
    switching = Switching(np.int64(3))
    assert switching == Switching(Fraction(3))
    assert type(switching.dwell_time.numerator) is int
