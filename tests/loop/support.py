"""What tests of modes share: the motion loop of the thesis, and how matrices are compared."""

from fractions import Fraction
from pathlib import Path

import numpy as np
from hypothesis import strategies as st
from scipy.optimize import linprog

from nrs_design.loop.assemble import assemble
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.pipeline.runs import run_design
from nrs_design.proof.exact import characteristic_polynomial, is_hurwitz
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.spec import LoadedSpec, parse_spec
from tests.support import SOFT_TISSUE, replaced

F = Fraction
# Thesis 6.3.2.2: Ap = [[0, 1], [-1618.80, -56.89]], Cp = [1618.80, 28.416].
LOOP = MotionLoop((F("28.416"), F("1618.80")), (F(1), F("56.89"), F("1618.80")))
MOTION = realize(LOOP)
positive = st.fractions("1/100", 100, max_denominator=1000)


def loaded(text, *changes, more=""):
    """Read a spec, the text or the file, in which pieces are replaced and lines added."""
    text = text if isinstance(text, str) else text.read_text(encoding="utf-8")
    text = replaced(text, *changes) + more
    return LoadedSpec(path=Path("drawn.nrs.yaml"), sha256="", text=text, spec=parse_spec(text))


def assembled(text, *changes, more=""):
    """Design and assemble such a spec, in deflection coordinates."""
    found = run_design(loaded(text, *changes, more=more))
    return assemble(found.spec, found.plant, found.design)


def sampled(sampling, *changes, text=SOFT_TISSUE):
    """Design and assemble a spec that is sampled, by default the one of soft tissue."""
    return assembled(text, *changes, more=f"\nsampling: {sampling}\n")


def polynomial(rows):
    """Coefficients of the characteristic polynomial, highest power first."""
    A = RationalMatrix.from_rows(rows)
    coefficients = characteristic_polynomial(A.numerators)
    return [F(c, A.denominator**k) for k, c in enumerate(coefficients)]


def stable(rows):
    """Whether a matrix is Hurwitz."""
    return is_hurwitz(RationalMatrix.from_rows(rows).numerators)


def outside(points, place):
    """How far a place is from the hull of points, which are columns; negative inside."""
    one = -np.ones((len(place), 1))
    done = linprog(
        [*np.zeros(points.shape[1]), 1],
        A_ub=np.block([[points, one], [-points, one]]),
        b_ub=[*place, *(-x for x in place)],
        A_eq=[[*np.ones(points.shape[1]), 0]],
        b_eq=[1],
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    assert done.status == 0, done.message
    return done.fun


def objects(*entries):
    """An array of exact numbers."""
    return np.array(entries, dtype=object)
