"""Parameters of a switched-system spec."""

from fractions import Fraction

import pytest

from tests.tables import spec_text

from .samples import refusal, switched


def test_a_matrix_needs_the_value_of_every_parameter() -> None:
    a, b = switched(spec_text("parameters")).modes
    assert a.matrix({"k": Fraction(1, 2)}) == [[0, 1], [Fraction(-5, 2), -1]]
    values = {"k": Fraction(4), "m": Fraction(1)}
    assert b.matrix(values) == [[0, 1], [Fraction(-5, 2), -1]]
    with pytest.raises(KeyError):
        b.matrix({"k": Fraction(1)})


def test_the_number_of_parameters_is_limited() -> None:
    names = [f"p{i}" for i in range(17)]
    listing = "".join(f"  {name}: {{nominal: 0, range: [-1, 1]}}\n" for name in names)
    text = (
        "kind: switched-system\nname: a\ntime: discrete\nswitching: arbitrary\n"
        f"parameters:\n{listing}modes:\n  - {{name: a, A: [[{' + '.join(names)}]]}}\n"
    )
    assert "parameters: more than" in refusal(text).message
    fewer = text.replace("  p16: {nominal: 0, range: [-1, 1]}\n", "").replace(" + p16", "")
    assert "65536 corners in all, at most 20000" in refusal(fewer).message
