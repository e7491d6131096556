"""A graph of switches that is stable by degree 4 and by no quadratic functions.

M. Philippe, R. Essick, G. E. Dullerud and R. M. Jungers, "Stability of discrete-time switching
systems with constrained switching sequences", Automatica 72 (2016) 242-250, section 4: a plant
whose controller may lose one or both of its gains, but not in any order. The constrained joint
spectral radius is 0.97482 (B. Legat, R. M. Jungers and P. A. Parrilo, "Generating unstable
trajectories for switched systems via dual sum-of-squares techniques", HSCC 2016). One form for
each node bounds it by 1.00358 in degree 2, 0.98635 in degree 4 and 0.97694 in degree 6
(SwitchOnSafety.jl, test/PEDJ16s4.jl).
"""

from fractions import Fraction

import pytest

from nrs_design.certificates.certify import Limits, Method, certify
from nrs_design.switched.system import Mode, Stay, SwitchedSystem, Switching, Time
from tests.certificates.systems import matrix

K1, K2 = Fraction("-0.49"), Fraction("0.27")
# All edges into a node carry the same gains, so the node is a mode, and its gains those on arrival.
GAINS = {"n1": (0, K2), "n2": (K1, 0), "n3": (K1, K2), "n4": (0, 0)}
EDGES = ("12", "21", "13", "31", "23", "32", "34", "43")
RADIUS = 0.9748171979372074
BOUNDS = {4: 0.9863468387970061, 6: 0.9769402921375085}


def network(scale=Fraction(1)):
    """Only node 3 has an edge to itself; the others are left after one step."""
    modes = tuple(
        Mode(
            name,
            matrix(
                [
                    [scale * Fraction("0.94"), scale * Fraction("0.56")],
                    [scale * (Fraction("0.14") + k1), scale * (Fraction("0.46") + k2)],
                ]
            ),
        )
        for name, (k1, k2) in GAINS.items()
    )
    stays = tuple((name, Stay(Fraction(1), Fraction(1))) for name in ("n1", "n2", "n4"))
    transitions = tuple((f"n{a}", f"n{b}") for a, b in EDGES)
    switching = Switching(transitions=transitions, stays=stays)
    return SwitchedSystem("network", Time.DISCRETE, ("x1", "x2"), modes, (), switching)


def test_no_quadratic_functions():
    """Their bound is 1.00358."""
    assert certify(network(), Method.MODE_QUADRATIC).verdict == "inconclusive"
    slower = certify(network(Fraction(99, 100)), Method.MODE_QUADRATIC)
    assert slower.verdict == "proved"
    assert float(slower.evidence.rate) == pytest.approx(0.99 * 1.0035769, abs=1e-4)


@pytest.mark.parametrize(("scale", "degree"), [("1", 4), ("1.02", 6)])
def test_the_published_rate_of_every_degree(scale, degree):
    """Scaled by 1.02, the bound of degree 4 is beyond one."""
    system = network(Fraction(scale))
    found = certify(system, Method.MODE_POLYNOMIAL)
    assert found.verdict == "proved"
    assert 2 * found.evidence.degree == degree
    rate = float(found.evidence.proved_rate(system)) / float(scale)
    assert RADIUS < rate < BOUNDS[degree] + 1e-4


def test_proved_by_default():
    found = certify(network())
    assert found.verdict == "proved"
    assert found.evidence.kind == "mode-polynomial"


def test_never_proved_beyond_the_radius():
    """1 / 0.97482 is 1.02583."""
    system = network(Fraction("1.026"))
    found = certify(system, limits=Limits(max_degree=8))
    assert found.verdict != "proved"
