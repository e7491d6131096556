"""Loops with ranges that are enclosed: what refutes them grows in a loop of the spec."""

import re
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.certificates.brief import brief
from nrs_design.certificates.certificate import Certificate, content_id, to_document
from nrs_design.certificates.goals import certified_goals
from nrs_design.certificates.prove import prove
from nrs_design.certificates.verify import verify_document
from nrs_design.errors import AssemblyError
from nrs_design.loop.assemble import assemble, assemble_from_text
from nrs_design.loop.cases import in_cases
from nrs_design.models.cut import MAX_PARTS, RangeCut
from nrs_design.pipeline.cases import CASES, find_cases
from nrs_design.pipeline.certification import assemble_spec, gains_text
from nrs_design.pipeline.runs import run_certification, run_design
from nrs_design.proof.evidence.growing_sequence import UNATTAINED, staying
from nrs_design.proof.switching import Reset, Switching
from nrs_design.search.certification import Limits
from nrs_design.search.certify import ENCLOSURE
from nrs_design.spec import LoadedSpec, load_spec, parse_spec, read_spec
from tests.proof.graphs import common_quadratic
from tests.support import ROOT, matrix


def torques(J, k, law, latency):
    """A joint between two inertias, at a controller with these stiffness and damping."""
    return f"""\
kind: interaction-design
name: torques
axis: prismatic
torque_interface:
  inertia: {{nominal: {J[0]} kg, range: [{J[0]} kg, {J[1]} kg], varies: false}}
  friction: 1 N*s/m
limits: {{velocity: 100 mm/s, torque: 20 N, bandwidth: 2 Hz}}
environments:
  table:
    model: elastic
    stiffness: {{nominal: {k[0]} N/m, range: [{k[0]} N/m, {k[1]} N/m], varies: false}}
controllers:
  c:
    type: torque-impedance
    environment: table
    stiffness: {law[0]} N/m
    damping: {law[1]} N*s/m
switching: arbitrary
sampling: {{period: 2 ms, delay: 0, latency: {latency}}}
contact: kept
"""


# The largest spectral radius of an admissible loop is 0.98951, by a grid of 40 x 60 values.
WHOLE = torques((5, 12), (1000, 20000), (1000, 125.2), "2 ms")
# Here it is 0.99624.
TORQUES = torques((2, 6), (1000, 20000), (564, 827.7), "1 ms")
UNSTABLE = torques((5, 12), (1000, 20000), (1000, 5000), "2 ms")
# It is from 0.9537 to 0.9710 for all lags.
LAG = """\
kind: interaction-design
name: lag
axis: prismatic
position_interface: {time_constant: {nominal: 0.02 s, range: [0.0045 s, 0.06 s], varies: false}}
limits: {velocity: 250 mm/s, torque: 50 N, bandwidth: 2 Hz}
environments: {hand: {model: elastic, stiffness: 300 N/m}}
controllers: {drag: {type: impedance, environment: hand, Mt: 5 kg, Bt: 60 N*s/m}}
switching: arbitrary
sampling: {period: 8 ms, delay: 0}
contact: kept
"""
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


@pytest.mark.parametrize(("text", "parts"), [(LAG, 2), (TORQUES, 4)])
def test_constant_ranges_are_proved_in_parts(text, parts):
    """A mode of the enclosure is not stable, which refutes nothing; each part has a proof."""
    result = decide(text, WORK)
    certification = result.certification
    assert certification.verdict == "proved"
    outcomes = {a.step: a.outcome for a in certification.attempts}
    assert "is not stable, and no loop of the spec need be there" in outcomes[ENCLOSURE]
    assert outcomes[CASES] == f"each of {parts} parts of the constant ranges has a proof"
    assert len(result.certificate.cuts) == parts - 1
    document = to_document(result.certificate) | {"id": result.certificate.id}
    assert verify_document(document, result.loaded).fault is None
    assert f"cut in {parts} parts" in document["assumptions"][-1]
    assert "at constant parameters" in brief(certification.evidence, certification.system)


@pytest.mark.parametrize(("wanted", "parts", "met"), [("2.5", 3, True), ("30", 2, False)])
def test_parts_are_cut_until_the_goal_is_met(wanted, parts, met):
    """Two parts decay with 0.46 1/s; what no lag reaches is asked of none."""
    loaded = loaded_of(f"{LAG}goals: {{decay_rate: {wanted} 1/s}}\n")
    certificate = run_certification(loaded).certificate
    assert len(certificate.cuts) == parts - 1
    (goal,) = certified_goals(loaded.spec, certificate)
    assert goal.met is met


def test_constants_do_not_change_within_a_period():
    """Enclosed as if they did, the ranges had to be cut in 18 parts."""
    certification = decide(WHOLE).certification
    assert (certification.verdict, certification.method) == ("proved", "constants quadratic")


CUT = RangeCut(0, "position_interface.time_constant", Fraction(9, 1075))


@pytest.mark.parametrize(
    ("cuts", "fault"),
    [
        ((), "'modes' is not that of the spec"),
        ((replace(CUT, at=Fraction(1, 100)),), "'modes' is not that of the spec"),
        ((CUT, replace(CUT, at=Fraction(1, 100))), "no part of a constant range is cut"),
        ((replace(CUT, at=Fraction(1, 400)),), "no part of a constant range is cut"),
        ((replace(CUT, part=1),), "no part of a constant range is cut"),
        ((replace(CUT, name="environments.hand.stiffness"),), "no part of a constant range is cut"),
        ((CUT,) * MAX_PARTS, "at most 64 are"),
    ],
)
def test_parts_that_are_not_those_of_the_certificate_are_refused(lags, cuts, fault):
    """Nothing of a range is left out: the parts follow from the cuts, and the modes from them."""
    assert lags.certificate.cuts == (CUT,)
    forged = replace(lags.certificate, cuts=cuts)
    document = to_document(forged) | {"id": forged.id}
    assert fault in verify_document(document, lags.loaded).fault


@pytest.fixture(scope="module")
def lags():
    return decide(LAG)


def test_a_part_left_out_is_missed(lags):
    """Also where what is left is proved."""
    whole = lags.certificate
    (names, _), (evidence,) = whole.system.cases, whole.statements
    system = replace(whole.system.only(names), cases=(names,))
    part = replace(evidence, nodes=evidence.nodes[:1], multipliers=())
    forged = replace(whole, system=system, statements=(part,))
    document = to_document(forged) | {"id": forged.id}
    assert prove(document).fault is None
    assert "'modes' is not that of the spec" in verify_document(document, lags.loaded).fault


@pytest.mark.parametrize(
    ("text", "most", "outcome"),
    [
        (UNSTABLE, 64, "none at torque_interface.iner"),
        (LAG, 1, "of 1 parts of the constant ranges, not all have a proof"),
        (TORQUES, 64, "the budget of 1 for all parts is used up (--budget)"),
    ],
)
def test_where_cutting_ends(text, most, outcome, monkeypatch):
    """At a middle without a proof, and where there are too many parts, or no work is left."""
    monkeypatch.setattr("nrs_design.pipeline.cases.MAX_PARTS", most)
    designed = run_design(loaded_of(text))
    constants = assemble_spec(designed.loaded, designed).switching.fixed_parameters
    found = find_cases(designed, constants, QUICK)
    assert found.outcome.startswith(outcome)
    assert not found.cuts
    assert not found.proved


def test_what_has_no_cases():
    """Points of the ranges, given matrices, and a loop of which a switch moves the state."""
    designed = run_design(loaded_of(LAG))
    with pytest.raises(AssemblyError, match="no system at the points"):
        assemble(designed.spec, designed.plant, designed.design, points="ends", cuts=(CUT,))
    with pytest.raises(AssemblyError, match="are not cut"):
        assemble_from_text(load_spec(ROOT / "docs/examples/flutter.nrs.yaml"), {}, cuts=(CUT,))
    system = assemble_spec(designed.loaded, designed)
    moved = replace(system, switching=Switching(resets=(Reset("a", "b", matrix([[1]])),)))
    for whole in (moved, replace(system, states=("x",))):
        with pytest.raises(AssemblyError, match="share no state, or a switch moves it"):
            in_cases(whole, (system, system))


def test_a_corner_of_a_preload_refutes_nothing():
    """Stiffness and damping follow one deflection; in continuous time a mode is one corner."""
    loaded = read_spec(ROOT / "specs/neuroboscope/concha.nrs.yaml")
    system = assemble_spec(loaded, run_design(loaded))
    unit = matrix([[int(i == j) for j in range(system.order)] for i in range(system.order)])
    growing = replace(system, modes=tuple(replace(mode, A=unit) for mode in system.modes))
    for mode in system.modes:
        assert UNATTAINED in staying(mode.name).find_fault(growing)
        assert staying(mode.name).find_fault(replace(growing, enclosures=())) is None


def test_the_kernel_refuses_a_forged_corner():
    """The mode is not stable; that it need not be attained is in the system."""
    loaded = loaded_of(TORQUES)
    designed = run_design(loaded)
    system = assemble_spec(loaded, designed)
    evidence = staying("c/table/k-min/J-max/hull-2")
    assert "surely unstable" in evidence.find_fault(system)
    assert evidence.find_fault(replace(system, enclosures=())) is None
    forged = Certificate(
        loaded.spec.name,
        loaded.sha256,
        "deflection",
        gains_text(designed),
        system,
        (evidence,),
        "0",
    )
    for enclosures, fault in ((system.enclosures, "surely unstable"), ((), "'enclosures' is not")):
        document = to_document(replace(forged, system=replace(system, enclosures=enclosures)))
        document["id"] = content_id(document)
        assert fault in verify_document(document, loaded).fault


def test_growth_does_not_belong_to_a_spec_without_its_enclosures():
    """Where a proof is checked beside, too: it knows the modes that the file holds."""
    result = decide(UNSTABLE)
    bare = replace(result.certificate, system=replace(result.certificate.system, enclosures=()))
    document = to_document(bare) | {"id": bare.id}
    said = verify_document(document, result.loaded, proof=lambda: None).fault
    assert "'enclosures' is not that of the spec" in said


def test_what_grows_at_the_ends_of_ranges_refutes():
    """Its certificate is about points of the ranges, and says so."""
    result = decide(UNSTABLE)
    assert result.certification.verdict == "refuted"
    assert result.certificate.points == "ends"
    document = to_document(result.certificate) | {"id": result.certificate.id}
    assert verify_document(document, result.loaded).fault is None
    assert any("at their ends" in text for text in document["assumptions"])
    grown = witness(result, (5.0, 12.0), (1000.0, 20000.0), (1000.0, 5000.0), (T,))
    assert radius(grown) == pytest.approx(1.3565, abs=0.01)


def test_a_proof_at_points_of_the_ranges_proves_nothing():
    result = decide(UNSTABLE)
    system = assemble(
        result.designed.spec, result.designed.plant, result.designed.design, points="ends"
    )
    stable = replace(
        system,
        modes=tuple(
            replace(m, A=matrix([[0] * m.A.shape[0]] * m.A.shape[0])) for m in system.modes
        ),
    )
    unit = tuple(tuple(int(i == j) for j in range(stable.order)) for i in range(stable.order))
    proof = common_quadratic(unit, 0, Fraction(1, 2))
    certificate = Certificate("s", "0" * 64, None, {}, stable, (proof,), "0", points="ends")
    document = to_document(certificate)
    document["id"] = content_id(document)
    assert "where only growth says something" in prove(document).fault
    del document["points"]
    document["id"] = content_id(document)
    assert prove(document).fault is None


def test_other_points_than_those_of_the_spec_are_not_read():
    result = decide(UNSTABLE)
    document = to_document(result.certificate) | {"points": "anywhere"}
    document["id"] = content_id(document)
    assert "no system at the points" in verify_document(document, result.loaded).fault


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
    """Of 200 loops, none is refuted without a loop that grows, and a tenth at most is open.

    Of the first 100, 3 are: their damping is so small that 64 parts are too few.
    """
    rng = np.random.default_rng(seed)
    each = [(*rng.uniform(0, 1, 6), int(rng.integers(3))) for _ in range(50)]
    verdicts = Counter(verdict_on(loop, WORK) for loop in each)
    assert verdicts["inconclusive"] <= 5, verdicts
