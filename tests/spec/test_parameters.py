"""Parameters of a switched-system spec."""

from fractions import Fraction

import pytest

from tests.tables import spec_text

from .samples import switched


def test_a_matrix_needs_the_value_of_every_parameter() -> None:
    a, b = switched(spec_text("parameters")).modes
    assert a.matrix({"k": Fraction(1, 2)}) == [[0, 1], [Fraction(-5, 2), -1]]
    values = {"k": Fraction(4), "m": Fraction(1)}
    assert b.matrix(values) == [[0, 1], [Fraction(-5, 2), -1]]
    with pytest.raises(KeyError):
        b.matrix({"k": Fraction(1)})
