"""How records are prepared, as it is typed."""

import pytest

from nrs_design.errors import DesignError
from nrs_design.identification.cli.identify import parse_arm
from nrs_design.identification.errors import DataError
from nrs_design.identification.tissue.settings import Preparation, read_preparation
from nrs_design.models.contact import Elastic
from tests.tables import rows


def test_every_field_can_be_set():
    entries = ("start=0.5", "end=2", "contact=given", "negate=true")
    assert read_preparation(entries) == Preparation(0.5, 2.0, "given", True)
    assert read_preparation(()) == Preparation()


@pytest.mark.parametrize(
    ("entry", "message"), rows(__file__, "test_what_is_none_is_refused_with_what_to_write")
)
def test_what_is_none_is_refused_with_what_to_write(entry, message):
    with pytest.raises(DesignError) as caught:
        read_preparation(entry.split())
    assert caught.value.message.startswith(message)
    assert caught.value.remedy


def test_thesis_arm():
    # Thesis 6.3.1.1: 747.1461 N/m at 0.24 m are 43.0356 N m/rad.
    arm = parse_arm("240 mm", rotational=False)
    assert Elastic(747.1461).convert_to_pivot(arm).k == pytest.approx(43.0356, abs=5e-5)


@pytest.mark.parametrize(("text", "rotational", "reason"), rows(__file__, "test_bad_arm"))
def test_bad_arm(text, rotational, reason):
    with pytest.raises(DataError, match=reason):
        parse_arm(text, rotational=rotational)
