"""A graph of switches that is stable by degree 4 and by no quadratic functions.

M. Philippe, R. Essick, G. E. Dullerud and R. M. Jungers, "Stability of discrete-time switching
systems with constrained switching sequences", Automatica 72 (2016) 242-250, section 4: a plant
whose controller may lose one or both of its gains, but not in any order. The constrained joint
spectral radius is 0.97482 (B. Legat, R. M. Jungers and P. A. Parrilo, "Generating unstable
trajectories for switched systems via dual sum-of-squares techniques", HSCC 2016). All edges into a
node carry the same gains, so each node is a mode here, with the gains on arrival. One form for
each node bounds it by 1.00358 in degree 2, 0.98635 in degree 4 and 0.97694 in degree 6
(SwitchOnSafety.jl, test/PEDJ16s4.jl).
"""

from fractions import Fraction

import pytest

from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method
from tests.proof.graphs import shape_of
from tests.proof.systems import lossy_network

RADIUS = 0.9748171979372074
BOUNDS = {4: 0.9863468387970061, 6: 0.9769402921375085}


def test_no_quadratic_functions():
    """Their bound is 1.00358."""
    assert certify(lossy_network(), Method.MODE_QUADRATIC).verdict == "inconclusive"
    slower = certify(lossy_network(Fraction(99, 100)), Method.MODE_QUADRATIC)
    assert slower.verdict == "proved"
    assert float(slower.evidence.rate) == pytest.approx(0.99 * 1.0035769, abs=1e-4)


@pytest.mark.parametrize(("scale", "degree"), [("1", 4), ("1.02", 6)])
def test_the_published_rate_of_every_degree(scale, degree):
    """Scaled by 1.02, the bound of degree 4 is beyond one."""
    system = lossy_network(Fraction(scale))
    found = certify(system, Method.MODE_POLYNOMIAL)
    assert found.verdict == "proved"
    assert 2 * found.evidence.degree == degree
    rate = float(found.evidence.proved_rate(system)) / float(scale)
    assert RADIUS < rate < BOUNDS[degree] + 1e-4


def test_proved_by_default():
    found = certify(lossy_network())
    assert found.verdict == "proved"
    assert shape_of(found.evidence) == "memory-quadratic"


def test_never_proved_beyond_the_radius():
    """1 / 0.97482 is 1.02583."""
    system = lossy_network(Fraction("1.026"))
    found = certify(system, limits=Limits(max_degree=8))
    assert found.verdict != "proved"
