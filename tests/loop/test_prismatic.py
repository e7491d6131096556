"""The axis of the thesis said as one that slides, everything carried over to a distance L."""

import re
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.runs import run_certification, run_design
from nrs_design.spec import read_spec
from tests.support import ROOT, run
from tests.tables import entry

SPEC = ROOT / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml"
# Powers of the distance by which a number is multiplied, and its unit there.
CARRIED = entry(__file__, "carried")
STATES = {"m": 1, "m/s": 1, "N": -1}


def turning(Bt="2.25", k="43.0356", tau="0.0351"):
    """The spec of the thesis in units of the pivot, with gains that single precision holds."""
    text = re.sub("#.*", "", SPEC.read_text(encoding="utf-8"))
    text = re.sub(r"stiffness: .*\n.*lever_arm: .*", f"stiffness: {k} N*m/rad", text)
    text = re.sub(r"time_constant: .*", f"time_constant: {tau} s", text)
    text = re.sub(r"Mt: \{.*\}", "Mt: 1/64 kg*m^2", text).replace("8 deg/s", "0.139 rad/s")
    text = re.sub(r"Bt: \{.*\}", f"Bt: {Bt} N*m*s/rad", text)
    return text.replace("56.9706 1/s", "57 1/s")


def sliding(text, L):
    """The same, at a distance from the pivot."""
    for unit, (power, other) in CARRIED.items():
        pattern = rf"([0-9][0-9.e+-]*(?:/[0-9]+)?) {re.escape(unit)}(?![\w*/^])"
        text = re.sub(pattern, lambda m: f"{Fraction(m[1]) * L**power} {other}", text)  # noqa: B023
    return text.replace("kind:", "axis: prismatic\nkind:", 1)


def both(tmp_path, L, **numbers):
    loaded = []
    for name, text in (("turns", turning(**numbers)), ("slides", sliding(turning(**numbers), L))):
        path = tmp_path / f"{name}.nrs.yaml"
        path.write_text(text, encoding="utf-8")
        loaded.append(read_spec(path))
    return loaded


def assembled(loaded):
    return assemble_spec(loaded, run_design(loaded))


def of_state(text, L):
    unit = text.partition(" [")[2][:-1]
    return L ** STATES.get(unit, 0)


# At a power of two, single precision rounds the same digits; the thesis has 0.24 m.
@pytest.mark.parametrize(("L", "near"), [(Fraction(1, 4), 0.0), (Fraction("0.24"), 1e-6)])
def test_the_modes_are_those_of_the_pivot_up_to_units(tmp_path, L, near):
    turns, slides = map(assembled, both(tmp_path, L))
    assert slides.states == ("e [m]", "omega [m/s]", *slides.states[2:])
    assert [mode.name for mode in slides.modes] == [mode.name for mode in turns.modes]
    scale = [of_state(text, L) for text in slides.states]
    for one, other in zip(turns.modes, slides.modes, strict=True):
        A, B = one.A.fractions(), other.A.fractions()
        carried = [
            [a * s / t for a, t in zip(row, scale, strict=True)]
            for row, s in zip(A, scale, strict=True)
        ]
        if near:
            found, wanted = (np.array(M, float) for M in (B, carried))
            np.testing.assert_allclose(found, wanted, rtol=near, atol=1e-9)
        else:
            assert carried == [[*row] for row in B]


def test_verdict_and_rate_are_the_same(tmp_path):
    results = map(run_certification, both(tmp_path, Fraction(1, 4)))
    one, other = (result.certification for result in results)
    assert one.verdict == other.verdict == "proved"
    rates = [float(c.statements[0].proved_rate(c.system)) for c in (one, other)]
    assert rates[0] == pytest.approx(rates[1], rel=1e-9)


# What an axis that slides has not; frequencies and phases are in rad/s and deg on both.
OF_A_TURN = re.compile(r"N\*m|N m\b|N·m|kg\*m|kg m|kg·m|deg/s|\brad\b(?!/s)")
FORMATS = ("c", "monitor", "coq", "json")


def test_no_output_speaks_of_a_turn(tmp_path):
    _, slides = both(tmp_path, Fraction(1, 4))
    path, out = slides.path, tmp_path / "made"
    run("certify-switching", path, "--out", "slides.cert.json", cwd=tmp_path)
    said = [(tmp_path / "slides.cert.json").read_text(encoding="utf-8")]
    for words in (
        ("check", path),
        ("optimize", path),
        ("tune", path),
        ("certify-switching", path),
        ("verify", "slides.cert.json", path),
        ("simulate", path, "--out", out),
        *(("export", path, "--format", each, "--out", out) for each in FORMATS),
    ):
        said.append(run(*words, cwd=tmp_path).stdout)
    files = (file for file in out.iterdir() if file.suffix not in (".png", ".svg"))
    said += [file.read_text(encoding="utf-8") for file in files]
    found = [m[0] for text in said for m in OF_A_TURN.finditer(text)]
    assert not found
