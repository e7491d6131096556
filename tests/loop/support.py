"""What tests of modes share: the motion loop of the thesis, and how matrices are compared."""

from fractions import Fraction

import numpy as np
from hypothesis import strategies as st

from nrs_design.design.design import design_controllers
from nrs_design.loop.assemble import assemble
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.proof.exact import characteristic_polynomial, is_hurwitz
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.spec import parse_spec
from nrs_design.spec.build_plant import build_plant

F = Fraction
# Thesis 6.3.2.2: Ap = [[0, 1], [-1618.80, -56.89]], Cp = [1618.80, 28.416].
LOOP = MotionLoop((F("28.416"), F("1618.80")), (F(1), F("56.89"), F("1618.80")))
MOTION = realize(LOOP)
positive = st.fractions("1/100", 100, max_denominator=1000)


def assembled(text):
    """Design and assemble a spec, in deflection coordinates."""
    spec = parse_spec(text)
    plant = build_plant(spec)
    return assemble(spec, plant, design_controllers(spec, plant))


def polynomial(rows):
    """Coefficients of the characteristic polynomial, highest power first."""
    A = RationalMatrix.from_rows(rows)
    coefficients = characteristic_polynomial(A.numerators)
    return [F(c, A.denominator**k) for k, c in enumerate(coefficients)]


def stable(rows):
    """Whether a matrix is Hurwitz."""
    return is_hurwitz(RationalMatrix.from_rows(rows).numerators)


def objects(*entries):
    """An array of exact numbers."""
    return np.array(entries, dtype=object)
