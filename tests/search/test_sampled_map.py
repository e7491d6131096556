"""What is proved and what is refuted of the sampled loop of the thesis, kept in contact.

Insertion and withdrawal (Bt 2.15 and 1.04) switched at will, the stiffness anywhere in [20, k] at
every sample, samples of 2 ms, a delay of so many of them. The largest k that an independent program
proved, and the smallest one along which its simulated signals grew.
"""

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method
from tests.search.support import thesis_robot
from tests.tables import entry

# Mt, delay, proved, refuted.
MAP = entry(__file__, "map")
QUICK = Limits(optimize_rate=False, max_degree=4)


def loop(Mt: str, delay: int, k: float) -> SwitchedSystem:
    sampling = f"{{period: 2 ms, delay: {delay}}}"
    return thesis_robot(("20", f"{k:.4g}"), ("2.15", "1.04"), Mt, sampling=sampling, contact="kept")


@pytest.mark.nightly
@pytest.mark.parametrize(("Mt", "delay", "proved", "refuted"), MAP)
def test_the_map_is_reached_on_both_sides(Mt, delay, proved, refuted):
    method = Method.POLYNOMIAL if delay < 2 else Method.MODE_QUADRATIC
    assert certify(loop(Mt, delay, proved), method, QUICK).verdict is Verdict.PROVED
    grown = certify(loop(Mt, delay, 1.01 * refuted), Method.PERIOD, QUICK)
    assert grown.verdict is Verdict.REFUTED


@pytest.mark.slow
def test_two_samples_of_delay_without_inertia_by_one_function_for_each_vertex():
    """A common quadratic function does not exist; the ends of enclosed numbers share theirs."""
    system = loop("0", 2, 53.1)
    assert certify(system, Method.OBSTRUCTION, QUICK).statements
    found = certify(system, Method.MODE_QUADRATIC, QUICK).evidence
    functions = dict(found.nodes)
    assert len(functions) == len(system.modes) == 8
    assert len(set(functions.values())) == 4
    for name, Q in functions.items():
        assert functions[name.replace("flow-0", "flow-1")] == Q


def test_a_stiffness_that_moves_along_with_the_switches_makes_it_grow():
    """Every mode of the family is stable, and so is every word of up to four steps."""
    system = loop("0.01", 0, 57.5)
    found = certify(system, Method.PERIOD, QUICK).evidence
    assert found.doublings is not None
    assert len({name.rpartition("/")[0] for name, _ in found.steps}) > 1
    assert sum(steps for _, steps in found.steps) > 4
    assert "some solution grow without bound" in found.claim(system)
