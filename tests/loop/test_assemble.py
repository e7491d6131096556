from fractions import Fraction

import pytest

from nrs_design.controllers.gains import gains_of
from nrs_design.errors import AssemblyError, CertificateError
from nrs_design.loop.assemble import GIVEN_MATRICES, assemble_from_text
from nrs_design.pipeline.runs import run_design
from nrs_design.proof.mode import Time
from nrs_design.spec import load_spec, parse_spec, read_spec
from nrs_design.spec.build_plant import build_plant
from tests.support import COMMUTING, FORCE_LIMIT, ROOT, SOFT_TISSUE, words_of

GIVEN_LOOP = """motion_loop:
  transfer_function:
    numerator: [28.416, 1618.80]
    denominator: [1, 56.89, 1618.80]
"""


def design_of(path):
    loaded = read_spec(path)
    design = run_design(loaded).design
    return loaded.spec, design, gains_of(design)


def test_given_matrices():
    system = assemble_from_text(load_spec(COMMUTING), {})
    assert [mode.name for mode in system.modes] == ["a", "b"]
    assert system.modes[1].A.numerators == ((-2, 3), (-3, -2))
    assert system.time is Time.CONTINUOUS
    assert system.states == ("x1", "x2")
    assert system.assumptions == GIVEN_MATRICES


def test_decimals_are_read_exactly():
    spec = parse_spec(
        "kind: switched-system\nname: s\ntime: discrete\nswitching: arbitrary\n"
        "modes: [{name: a, A: [[-0.36, 1e-100], ['1/6', 0.1]]}]\n"
    )
    system = assemble_from_text(spec, {})
    assert system.modes[0].A.fractions() == [
        [Fraction(-9, 25), Fraction(1, 10**100)],
        [Fraction(1, 6), Fraction(1, 10)],
    ]
    assert system.time is Time.DISCRETE


def test_given_matrices_have_no_design():
    with pytest.raises(AssemblyError, match="have no gains"):
        assemble_from_text(load_spec(COMMUTING), {"motion": {}})


def test_designs_come_back_from_their_gains():
    spec, _, gains = design_of(SOFT_TISSUE)
    system = assemble_from_text(spec, gains)
    assert system.name == "soft-tissue"
    assert system.order == 4
    Bt = Fraction(gains["insertion"]["Bt"])
    Mt = Fraction(gains["insertion"]["Mt"])
    assert system.modes[0].A.fractions()[2][2] == -Bt / Mt


def test_a_motion_that_begins_with_a_force_may_have_a_filter_that_shows_it(tmp_path):
    text = (ROOT / "docs/examples/saturating.nrs.yaml").read_text("utf-8")
    filtered = text.replace("limits:", "sensor: {filter: {order: 2, cutoff: 20 Hz}}\nlimits:")
    path = tmp_path / "filtered.nrs.yaml"
    path.write_text(filtered, "utf-8")
    spec, _, gains = design_of(path)
    system = assemble_from_text(spec, gains)
    states = [[entry for (entry,) in x.fractions()] for x in system.saturation.start.states]
    shown = [(*(state[i] for i in (3, 4)),) for state in states]
    assert [system.states[i] for i in (3, 4)] == ["filtered 1 [N*m]", "filtered 2 [N*m]"]
    assert shown == [(0, 0), (1, 1), (0, 0), (1, 1)]
    assert all(state[5] > 0 and not any(state[:3]) for state in states)
    assert any("any part, each lag the same" in text for text in words_of(system))


def test_missing_gains():
    spec, _, gains = design_of(FORCE_LIMIT)
    with pytest.raises(CertificateError, match="gains"):
        assemble_from_text(spec, {"motion": gains["motion"]})


def test_motion_loop_that_the_spec_states():
    text = SOFT_TISSUE.read_text().replace("motion_loop:\n", GIVEN_LOOP)
    spec = parse_spec(text)
    _, design, _ = design_of(SOFT_TISSUE)
    loop = build_plant(spec).motion_loop(design.motion.Kp, design.motion.Kd)
    assert loop.numerator == (Fraction("28.416"), Fraction("1618.80"))
    assert loop.denominator == (Fraction(1), Fraction("56.89"), Fraction("1618.80"))
