"""Loops with ranges that are enclosed: what refutes them grows in a loop of the spec."""

import re
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.certificates.certificate import Certificate, content_id, to_document
from nrs_design.certificates.prove import prove
from nrs_design.certificates.verify import verify_document
from nrs_design.loop.assemble import assemble
from nrs_design.pipeline.certification import assemble_spec, gains_text
from nrs_design.pipeline.runs import run_certification, run_design
from nrs_design.proof.evidence.growing_sequence import UNATTAINED, staying
from nrs_design.search.certification import Limits
from nrs_design.spec import LoadedSpec, parse_spec, read_spec
from tests.proof.graphs import common_quadratic
from tests.support import ROOT, matrix, replaced
from tests.tables import spec_text


def torques(J, k, law, latency):
    """A joint between two inertias, at a controller with these stiffness and damping."""
    names = ("LIGHT", "HEAVY", "SOFT", "STIFF", "SPRING", "DAMPER", "LATENCY")
    said = map(str, (*J, *k, *law, latency))
    return replaced(spec_text("torques"), *zip(names, said, strict=True))


# The largest spectral radius of an admissible loop is 0.98951, by a grid of 40 x 60 values.
WHOLE = torques((5, 12), (1000, 20000), (1000, 125.2), "2 ms")
UNSTABLE = torques((5, 12), (1000, 20000), (1000, 5000), "2 ms")
QUICK = Limits(budget=2.0, optimize_rate=False, more=False)
WORK = 60.0  # As by default
# Of a torque-controlled loop: period in s, friction in N s/m, and for inertia in kg, stiffness of
# what is touched in N/m and of the controller, and its damping in N s/m, the logarithm of two.
T, FRICTION = 0.002, 1.0
values = st.floats(0, 1, allow_subnormal=False)
loops = st.tuples(values, values, values, values, values, values, st.sampled_from([0, 1, 2]))


def spec_of(loop):
    """Return a loop with wide ranges of constants, and where its numbers are."""
    inertia, wide, stiffness, stiff, K, D, late = loop
    J = round(2 + 10 * inertia, 2), round((2 + 10 * inertia) * (1 + 3 * wide), 2)
    k = round(300 * 30**stiffness), round(300 * 30**stiffness * (1.1 + 9 * stiff))
    law = round(300 * 10**K), round(20 * 200**D, 1)
    latency = ("0 ms", "2 ms", "{range: [0.4 ms, 1.6 ms], varies: false}")[late]
    lates = ((0.0,), (T,), (0.0004, 0.0016))[late]
    return torques(J, k, law, latency), J, k, law, lates


def step(J, k, law, late):
    """The map of a period of [speed, error before, command before, deflection]."""
    G = np.array([[-FRICTION / J, -k / J, 1 / J], [1, 0, 0], [0, 0, 0]])
    first, last = expm(G * late), expm(G * (T - late))
    K, D = law
    command = np.array([0.0, -D / T, 0.0, -K - D / T])
    before = np.array([0.0, 0.0, 1.0, 0.0])
    z = np.zeros((2, 4))
    z[0, 0] = z[1, 3] = 1
    z = first[:2, :2] @ z + np.outer(first[:2, 2], before)
    z = last[:2, :2] @ z + np.outer(last[:2, 2], command)
    return np.array([z[0], [0, 0, 0, -1.0], command, z[1]])


def radius(M):
    return np.abs(np.linalg.eigvals(M)).max()


def largest(J, k, law, lates):
    """The largest spectral radius on a grid of constants, its ends with it."""
    grid = product(np.geomspace(*J, 12), np.geomspace(*k, 16), np.linspace(lates[0], lates[-1], 4))
    return max(radius(step(m, stiffness, law, late)) for m, stiffness, late in grid)


def loaded_of(text):
    return LoadedSpec(path=Path("loop.nrs.yaml"), sha256="", text=text, spec=parse_spec(text))


def decide(text, work=QUICK.budget):
    return run_certification(loaded_of(text), limits=replace(QUICK, budget=work))


def witness(found, J, k, law, lates):
    """The product of the maps along the sequence that a certificate names, at real values."""
    evidence = found.certification.evidence
    ends = {"J": J, "k": k, "h0": (T - lates[-1], T - lates[0])}
    total, constants = np.eye(4), []
    for name, count in evidence.steps:
        label = dict(re.findall(r"/(\w+)-(min|max)", name))
        at = {s: both[label.get(s) == "max"] for s, both in ends.items()}
        constants.append(at)
        total = (
            np.linalg.matrix_power(step(at["J"], at["k"], law, T - at["h0"]), int(count)) @ total
        )
    assert all(at == constants[0] for at in constants)
    return total


def unit_rows(system):
    return tuple(tuple(int(i == j) for j in range(system.order)) for i in range(system.order))


def signed(certificate):
    """The document of a certificate that somebody else wrote."""
    document = to_document(certificate)
    return document | {"id": content_id(document)}


def fault_of(certificate, loaded):
    return verify_document(signed(certificate), loaded).fault


def test_constants_do_not_change_within_a_period():
    """Enclosed as if they did, the ranges had to be cut in 18 parts."""
    certification = decide(WHOLE).certification
    assert (certification.verdict, certification.method) == ("proved", "constants quadratic")


def test_a_corner_of_a_preload_refutes_nothing():
    """Stiffness and damping follow one deflection; in continuous time a mode is one corner."""
    loaded = read_spec(ROOT / "specs/neuroboscope/concha.nrs.yaml")
    system = assemble_spec(loaded, run_design(loaded))
    unit = matrix(unit_rows(system))
    growing = replace(system, modes=tuple(replace(mode, A=unit) for mode in system.modes))
    for mode in system.modes:
        assert UNATTAINED in staying(mode.name).find_fault(growing)
        assert staying(mode.name).find_fault(replace(growing, enclosures=())) is None


def test_the_kernel_refuses_a_forged_corner():
    """The mode is not stable; that it need not be attained is in the system."""
    loaded = loaded_of(UNSTABLE)
    designed = run_design(loaded)
    system = assemble_spec(loaded, designed)
    evidence = staying("c/table/k-min/J-max/flow-2")
    assert "surely unstable" in evidence.find_fault(system)
    assert evidence.find_fault(replace(system, enclosures=())) is None
    names, gains = (loaded.spec.name, loaded.sha256, "deflection"), gains_text(designed)
    forged = Certificate(*names, gains, system, (evidence,), "0")
    assert "surely unstable" in fault_of(forged, loaded)
    bare = replace(forged, system=replace(system, enclosures=()))
    assert "'enclosures' is not" in fault_of(bare, loaded)


def test_growth_does_not_belong_to_a_spec_without_its_enclosures():
    result = decide(UNSTABLE)
    bare = replace(result.certificate, system=replace(result.certificate.system, enclosures=()))
    assert "'enclosures' is not that of the spec" in fault_of(bare, result.loaded)


def test_what_grows_at_the_ends_of_ranges_refutes():
    """Its certificate is about points of the ranges, and says so."""
    result = decide(UNSTABLE)
    assert result.certification.verdict == "refuted"
    assert result.certificate.points == "ends"
    assert fault_of(result.certificate, result.loaded) is None
    said = {one["id"]: one for one in to_document(result.certificate)["assumptions"]}
    assert said["range.points"]["fields"] == [["points", ["ends"]]]
    grown = witness(result, (5.0, 12.0), (1000.0, 20000.0), (1000.0, 5000.0), (T,))
    assert radius(grown) == pytest.approx(1.3565, abs=0.01)


def test_a_proof_at_points_of_the_ranges_proves_nothing():
    result = decide(UNSTABLE)
    one = result.designed
    system = assemble(one.spec, one.plant, one.design, points="ends")
    nothing = matrix([[0] * system.order] * system.order)
    stable = replace(system, modes=tuple(replace(m, A=nothing) for m in system.modes))
    proof = common_quadratic(unit_rows(system), 0, Fraction(1, 2))
    certificate = Certificate("s", "0" * 64, None, {}, stable, (proof,), "0", points="ends")
    assert "where only growth says something" in prove(signed(certificate)).fault
    assert prove(signed(replace(certificate, points=""))).fault is None


def test_other_points_than_those_of_the_spec_are_not_read():
    result = decide(UNSTABLE)
    elsewhere = replace(result.certificate, points="anywhere")
    assert "no system at the points" in fault_of(elsewhere, result.loaded)


def verdict_on(loop, work=QUICK.budget):
    """Decide a loop: what refutes it grows at real values, what is proved does not on a grid."""
    text, J, k, law, lates = spec_of(loop)
    result = decide(text, work)
    verdict = result.certification.verdict
    if verdict == "refuted":
        assert radius(witness(result, J, k, law, lates)) > 1
    elif verdict == "proved":
        assert largest(J, k, law, lates) < 1
    return verdict


@pytest.mark.slow
@given(loops)
@settings(max_examples=12)
def test_nothing_admissible_is_refuted(loop):
    verdict_on(loop)


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(4))
def test_many_loops(seed):
    """Of 200 loops, none is refuted without a loop that grows."""
    rng = np.random.default_rng(seed)
    for _ in range(50):
        verdict_on((*rng.uniform(0, 1, 6), int(rng.integers(3))), WORK)
