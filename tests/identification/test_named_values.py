"""Settings that are typed as NAME=VALUE."""

import pytest

from nrs_design.errors import DesignError
from nrs_design.identification.named_values import read_named_values
from tests.tables import rows

READERS = {"length": float, "name": str}


def test_values_are_read_by_name():
    assert read_named_values((), READERS, "a rod") == {}
    read = read_named_values(("name=a=b", "length=1e-3"), READERS, "a rod")
    assert read == {"name": "a=b", "length": 1e-3}


@pytest.mark.parametrize(
    ("entries", "message"), rows(__file__, "test_what_is_no_setting_is_refused")
)
def test_what_is_no_setting_is_refused(entries, message):
    with pytest.raises(DesignError) as caught:
        read_named_values(entries, READERS, "a rod")
    assert caught.value.message == message
    assert caught.value.remedy
