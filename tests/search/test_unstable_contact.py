"""The search for growth with loss of contact, and what it finds against the definition."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.evidence.abstract import AT_ANY_DEFLECTION
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search import unstable_contact
from nrs_design.search.acceptance import first_accepted
from nrs_design.search.certify import Limits, certify, refuted_at_once
from nrs_design.search.family import Family
from nrs_design.search.method import Method
from nrs_design.search.unstable_contact import NOTHING_GROWS, search_contact
from nrs_design.search.work import Allowance, NotAffordableError
from tests.proof import systems
from tests.search.support import thesis_robot
from tests.search.test_losable_brute_force import rounded


def found_in(system):
    return first_accepted(search_contact(Family.of(system)), system)


def drawn(seed: int) -> SwitchedSystem:
    """Draw a loop of two states and a deflection that may leave what it touches."""
    rng = np.random.default_rng(seed)
    free = np.zeros((3, 3))
    free[:2, :2] = rng.uniform(-1, 1, (2, 2))
    free[:2, :2] *= 0.9 / np.abs(np.linalg.eigvals(free[:2, :2])).max()
    free[2] = [1, rng.uniform(-1, 1), 1]
    push = np.outer([*rng.uniform(-2, 2, 2), 0], [0, 0, 1])
    contact = Contact((Mode("free", rounded(free)),), required=True)
    touching = rounded(free - push).fractions()
    system = systems.family(touching, time=Time.DISCRETE, names=["touch"])
    return replace(system, states=("v", "w", "delta"), contact=contact)


def grown(system: SwitchedSystem, evidence: GrowingSequence, times: int) -> float:
    """Follow the witness by the words: the deflection alone says whether there is contact.

    Return how many times larger motion and penetration are after some periods.
    """
    modes = (*system.modes, *system.contact.free)
    matrices = {mode.name: np.array(mode.A.floats(), dtype=float) for mode in modes}
    names = [name for name, count in evidence.steps for _ in range(int(count))]
    M = np.eye(3)
    for name in names:
        M = matrices[name] @ M
    values, vectors = np.linalg.eig(M)
    v = vectors[:, np.abs(values - float(evidence.factor[0])).argmin()].real
    x = v if (v[2] > 0) == (names[0] == "touch") else -v
    begin = np.linalg.norm([x[0], x[1], max(x[2], 0)])
    for _ in range(times * len(names)):
        x = matrices["touch" if x[2] > 0 else "free"] @ x
    return float(np.linalg.norm([x[0], x[1], max(x[2], 0)]) / begin)


def test_what_refutes_random_losable_loops_grows_by_the_definition():
    refuted = []
    for seed in range(40):
        system = drawn(seed)
        evidence, _ = found_in(system)
        if evidence is not None:
            refuted.append(evidence)
            factor = float(evidence.factor[0])
            assert grown(system, evidence, 3) == pytest.approx(factor**3, rel=1e-6)
    assert len(refuted) > 4


@pytest.mark.parametrize(
    "system", [systems.juggling, systems.juggling_among_modes, systems.juggling_in_turns]
)
def test_a_sequence_of_contact_and_flight_is_found(system):
    evidence, _ = found_in(system())
    assert [count for _, count in evidence.steps] == [1, 1]
    assert certify(system()).verdict is Verdict.REFUTED


def test_a_mode_that_draws_in_is_found_in_continuous_time():
    evidence, _ = found_in(systems.sucking_in())
    assert evidence.steps == (("m0", 1),)
    assert certify(systems.sucking_in()).verdict is Verdict.REFUTED
    losable = replace(
        systems.bouncing(), contact=replace(systems.bouncing().contact, required=True)
    )
    assert "no mode has a real eigenvalue" in found_in(losable)[1]


def test_what_decays_has_no_witness():
    system = systems.bouncing_in_steps()
    losable = replace(system, contact=replace(system.contact, required=True))
    assert found_in(losable) == (None, NOTHING_GROWS)


def test_enclosing_a_sequence_is_paid_for(monkeypatch):
    monkeypatch.setattr(unstable_contact, "PER_ENTRY", 1.0)
    searched = search_contact(Family.of(systems.juggling(), Allowance(1.0)))
    with pytest.raises(NotAffordableError, match="the enclosure of a sequence would take"):
        next(searched)


def turning(kept: str) -> SwitchedSystem:
    """A spring that is too stiff for its steps: it grows in kept contact, and flies away."""
    free = Mode("free", systems.matrix([[kept, 0], [1, 1]]))
    system = systems.family([[kept, "-6/5"], [1, 1]], time=Time.DISCRETE, names=["touch"])
    return replace(system, states=("v", "delta"), contact=Contact((free,), required=True))


def turning_among_modes() -> SwitchedSystem:
    """The same, that may leave what it touches anywhere: neither mode is stable."""
    system, flights = turning("9/10"), Flights(("touch",), ("free",))
    modes = (*system.modes, *system.free)
    return replace(system, modes=modes, contact=None, flights=flights)


@pytest.mark.parametrize(
    ("system", "verdict", "where"),
    [
        (systems.drifting(), Verdict.REFUTED, None),
        (turning_among_modes(), Verdict.INCONCLUSIVE, AT_ANY_DEFLECTION),
    ],
)
def test_free_motion_is_judged_first_and_named(system, verdict, where):
    result = certify(system)
    assert (result.verdict, result.refuted_in) == (verdict, where)
    assert result.attempts[0].outcome == "mode free is not stable"
    assert result.statements[0].names_unstable_mode
    assert refuted_at_once(system) == (where or "")


def test_what_grows_in_and_out_of_contact_refutes_before_what_grows_in_one_of_them():
    system = turning_among_modes()
    either = Mode("either", systems.matrix([[1, -2], [1, 1]]))
    result = certify(replace(system, modes=(*system.modes, either)))
    assert result.verdict is Verdict.REFUTED
    assert result.evidence.steps == (("either", 1),)


def test_growth_in_kept_contact_leaves_the_verdict_open():
    system = turning("9/10")
    for method in (Method.AUTO, Method.PERIOD):
        result = certify(system, method)
        assert (result.verdict, result.refuted_in) == (Verdict.INCONCLUSIVE, "in kept contact")
        assert result.evidence is None
        assert [item.kind for item in result.statements] == ["growing-sequence"]
        # What speaks of kept contact is not searched any further.
        assert result.attempts[-1].step == "growth with loss of contact"
    assert refuted_at_once(system) == "in kept contact"
    assert not refuted_at_once(replace(system, contact=None))
    assert certify(replace(system, contact=None)).verdict is Verdict.REFUTED
    slower = turning("-1/2")
    assert refuted_at_once(slower) is None


def following(system: SwitchedSystem) -> SwitchedSystem:
    """Let the surface follow the axis: it stays behind it, or meets it wherever it moves in.

    A flight keeps its distance, or ends with the deflection that is the way of the last step.
    """

    def cut(mode: Mode, *, meets: bool) -> Mode:
        *rows, last = mode.A.fractions()
        stays = [*(0 for _ in rows), 1]
        row = [*last[:-1], 0] if meets else stays
        return Mode(f"{mode.name}/{'met' if meets else 'away'}", systems.matrix([*rows, row]))

    flying = tuple(cut(mode, meets=meets) for mode in system.free for meets in (True, False))
    names = [tuple(mode.name for mode in part) for part in (system.modes, flying)]
    return replace(
        system, modes=(*system.modes, *flying), contact=None, roundings=(), flights=Flights(*names)
    )


def test_growth_on_a_surface_that_follows_is_found():
    """The robot of the thesis, withdrawal, a force sample of five periods; kept contact: 39.4.

    A positive control of the search, at a stiffness at which nothing grows on a surface that stays.
    The corners of the motor are modes of their own here, and enclose nothing.
    """
    sampling = "{period: 2 ms, delay: 5}"
    system = thesis_robot(("8000", "8000"), ("1.04",), "0.01", sampling=sampling, contact="losable")
    system = replace(system, enclosures=())
    evidence, _ = found_in(following(system))
    assert isinstance(evidence, GrowingSequence)
    assert evidence.find_fault(following(system)) is None
    assert found_in(system)[0] is None
    # Each of both is needed: contact, and flights that end where the surface comes.
    parts = {name.split("/")[-1] for name, _ in evidence.steps}
    assert "met" in parts
    assert any(name.startswith("c0/soft") for name, _ in evidence.steps)


@pytest.mark.parametrize(("Bt", "delay", "border"), [("2.15", 1, 133.6), ("1.04", 5, 39.4)])
def test_proofs_reach_to_the_border_of_kept_contact_and_not_beyond(Bt, delay, border):
    """Just above it, where kept contact grows, nothing is shown and nothing is refuted."""
    for share, verdict in ((0.995, "proved"), (1.005, "inconclusive")):
        k = f"{share * border:.3f}"
        sampling = f"{{period: 2 ms, delay: {delay}}}"
        system = thesis_robot((k, k), (Bt,), "0.01", sampling=sampling, contact="losable")
        found = certify(system, limits=Limits(optimize_rate=False, budget=20.0))
        assert str(found.verdict) == verdict
