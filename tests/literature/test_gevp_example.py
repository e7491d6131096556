"""The MathWorks, Robust Control Toolbox, reference page of ``gevp``, example.

The least alpha with ``A'P + PA < alpha P``, ``P > I`` for three modes is -0.122131, so the best
quadratic decay rate is half of 0.122131.
"""

from .known import known, settle


def test_decay_rate_reaches_the_published_optimum_and_never_exceeds_it():
    optimum = -float(known("gevp-doc").alpha)
    rate = 2 * float(settle("gevp-doc").evidence.rate)
    # Half a unit of the last published digit.
    assert (1 - 1e-3) * optimum <= rate <= optimum + 5e-7
