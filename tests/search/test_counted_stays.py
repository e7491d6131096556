"""Forms for controllers that stay in force for a while."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.switching import Clock
from nrs_design.search.certification import Verdict
from nrs_design.search.certify import certify
from nrs_design.search.counted_stays import stays_of
from tests.loop.support import assembled
from tests.proof.systems import bouncing_in_turns, doubled_in_turns, sheared_in_stays
from tests.tables import spec_text


def test_which_automata_count_stays():
    assert stays_of(sheared_in_stays(3).clock) == [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
    assert stays_of(sheared_in_stays(1).clock) == [[0], [1], [2]]
    for other in (doubled_in_turns(3), bouncing_in_turns()):
        assert stays_of(other.clock) is None
    # At most one of any three missed, and a state that no stay leads to.
    assert stays_of(Clock(3, ("m0",), ((0, 1), (2, -1), (0, -1)))) is None
    assert stays_of(Clock(3, ("m0",), ((0, 1), (0, 1), (0, 1)))) is None


@pytest.mark.parametrize("count", range(1, 9))
def test_shears_are_decided_at_every_dwell_time(count):
    """Of N steps each they keep ``(1 + 2 N^2 + 2 N sqrt(N^2 + 1))/4^N``: below one from 3 on."""
    kept = (1 + 2 * count**2 + 2 * count * np.sqrt(count**2 + 1)) / 4**count
    found = certify(sheared_in_stays(count))
    assert found.verdict is (Verdict.PROVED if kept < 1 else Verdict.REFUTED)
    if kept < 1:
        assert kept ** (1 / (2 * count)) <= found.statements[0].rate < 1


def test_one_form_is_enough_where_switching_is_free():
    system = sheared_in_stays(3)
    calm = replace(system, modes=(system.modes[2], *system.modes[1:]))
    calm = replace(calm, modes=(replace(calm.modes[0], name="m0"), *calm.modes[1:]))
    (graph,) = certify(calm).statements
    assert isinstance(graph, FormsOnGraph)
    assert len({node.form for node in graph.nodes}) == 1


SPEC = spec_text("two-stiffnesses")


def test_a_sampled_loop_that_needs_its_dwell_time():
    """Also where contact is lost and made, and with what the arithmetic rounds."""
    system = assembled(SPEC)
    assert (system.clock.length, len(system.clock.kinds)) == (160, 2)
    found = certify(system)
    (graph,) = found.statements
    assert found.verdict is Verdict.PROVED
    assert graph.covers_rounding
    assert len({node.form for node in graph.nodes}) == len(graph.nodes)
    # Longer products of the modes that keep the rule decay at the proved rate.
    rng, matrices = np.random.default_rng(0), np.array([m.A.floats() for m in system.modes])
    kinds = np.array(system.clock.kind_of(mode.name for mode in system.modes))
    for _ in range(20):
        state, whole, steps = 0, np.eye(system.order), 2000
        for _ in range(steps):
            may = [k for k in (0, 1) if system.clock.after(state, k) is not None]
            kind = rng.choice(may)
            state = system.clock.after(state, kind)
            whole = matrices[rng.choice(np.flatnonzero(kinds == kind))] @ whole
        size = np.abs(np.linalg.eigvals(whole)).max() ** (1 / steps)
        assert size <= float(graph.rate)


def test_stays_that_no_switch_ends():
    system = sheared_in_stays(2)
    ahead = tuple(
        tuple(target if target // 2 == state // 2 else -1 for target in leads)
        for state, leads in enumerate(system.clock.ahead)
    )
    found = certify(replace(system, clock=replace(system.clock, ahead=ahead)))
    assert found.verdict is Verdict.PROVED
