"""Every kind of quantity: its example, its units, and what is said of units taken for them."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import kinds
from nrs_design.spec.quantity import QuantityKind, parse_quantity

NAMED = {name: kind for name, kind in vars(kinds).items() if isinstance(kind, QuantityKind)}


@pytest.mark.parametrize("kind", NAMED.values(), ids=NAMED)
def test_examples_are_of_their_kind(kind):
    assert parse_quantity(kind.example, kind).value > 0
    for confusion, advice in kind.confusions.items():
        with pytest.raises(SpecError) as caught:
            parse_quantity(f"3 {confusion}", kind)
        assert caught.value.remedy == advice.format(value="3")


def test_what_enters_a_proof_has_no_factor_of_pi():
    """Angles and frequencies are bounds and goals; all others are exact numbers of a proof.

    Of the deflections of a preload, only their ratios are. Joint positions are rounded outwards.
    """
    assert {name for name, kind in NAMED.items() if not kind.rational} == {
        *("ANGLE", "ANGULAR_ACCELERATION", "ANGULAR_VELOCITY"),
        *("BANDWIDTH", "DEFLECTION", "PHASE"),
    }
    with pytest.raises(SpecError, match="pi"):
        parse_quantity("3 N*mm/deg", kinds.STIFFNESS)
    assert parse_quantity("30 deg", kinds.ANGLE).value == 30
