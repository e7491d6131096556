"""Which lines of a spec keep it from being proved, and how far each is proved."""

import re
from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.pipeline.blocked import Blocked, blocked_lines, find_blocked, line_text
from nrs_design.pipeline.runs import run_certification
from nrs_design.search.certification import Limits
from nrs_design.spec import read_spec
from tests.support import COMMUTING, PRINT_ERROR, ROOT, SOFT_TISSUE, spec_in
from tests.tables import spec_text

EXACT = "stiffness: {nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}\n    lever_arm: 0.24 m"
SAMPLED = "\nsampling: {period: 2 ms, delay: DELAY}\ncontact: losable\n"


def soft(low: str, high: str, delay: str = "0") -> str:
    """Insertion and withdrawal, sampled, in tissue whose stiffness in N*m/rad may be lost."""
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    assert EXACT in text
    wide = f"stiffness: {{nominal: 43 N*m/rad, range: [{low} N*m/rad, {high} N*m/rad]}}"
    return text.replace(EXACT, wide) + SAMPLED.replace("DELAY", delay)


def late() -> str:
    """The force of the thesis loop, up to five samples old."""
    return SOFT_TISSUE.read_text(encoding="utf-8") + SAMPLED.replace("DELAY", "[0, 5]")


def hand() -> str:
    """A hand with a mass, whose damping may be a fifth of what the example needs."""
    text = (ROOT / "docs/examples/hand-with-mass.nrs.yaml").read_text(encoding="utf-8")
    assert "range: [4 N*m*s/rad" in text
    return text.replace("range: [4 N*m*s/rad", "range: [1.5 N*m*s/rad")


# The same, of one age that is too much; with what disturbs besides.
LATE = late().replace("[0, 5]", "4") + "disturbances: {command: 8 deg/s}\n"
# Geromel and Colaneri 2006: proved from 2.7508 s on, and up to 2.7077 s a signal grows.
PAIR = spec_text("stiff-and-soft")
HARD = spec_text("hard")
# Zelentsovsky 1994: stable for k in [0, K] iff K < 6.98513.
OSCILLATOR = spec_text("oscillator")


def blocked(tmp_path: Path, text: str, budget: float) -> Blocked:
    """Find what blocks a text that is not decided in a budget; its work is less than half."""
    path = spec_in(tmp_path, text, "a")
    limits = Limits(optimize_rate=False, budget=budget)
    result = run_certification(read_spec(path), limits=limits)
    assert result.certification.verdict is Verdict.INCONCLUSIVE
    found = find_blocked(result, limits)
    assert found is not None
    assert found.work < budget / 2
    assert len(blocked_lines(found, path)) <= 5
    return found


def verdict(tmp_path: Path, text: str, budget: float) -> Verdict:
    path = spec_in(tmp_path, text, "b")
    limits = Limits(optimize_rate=False, budget=budget)
    return run_certification(read_spec(path), limits=limits).certification.verdict


def texts(found: Blocked) -> list[str]:
    return [" + ".join(line_text(line) for line in item.lines) for item in found.proved]


@pytest.mark.nightly
def test_an_end_of_a_range_is_what_bisection_by_hand_finds(tmp_path):
    """The line that is advised is proved; the next step beyond it is not, with as much work."""
    found = blocked(tmp_path, soft("20", "60"), 4)
    (line,) = found.proved[0].lines
    assert (line.line, line.word, line.asked) == (
        "environments.soft.stiffness.range",
        "up to",
        "60 N*m/rad",
    )
    top = Fraction(line.proved.split(" ")[0])
    # `tests/search/test_sampled_map.py`: in kept contact, 52.0 is proved and 57.5 refuted.
    assert 45 < top < 57.5
    assert line.write == f"range: [20 N*m/rad, {line.proved}]"
    assert verdict(tmp_path, soft("20", line.proved.split(" ")[0]), 1) is Verdict.PROVED
    assert verdict(tmp_path, soft("20", str(float(top) + 17 / 64)), 0.3) is not Verdict.PROVED


@pytest.mark.nightly
def test_the_age_of_the_force_sample(tmp_path):
    found = blocked(tmp_path, late(), 3)
    (line,) = found.proved[0].lines
    assert line.line == "sampling.delay"
    assert late().splitlines()[line.place.line - 1].startswith("sampling: ")
    assert (line.proved, line.asked) == ("2 samples", "5 samples")
    # The gains are chosen for the longest delay.
    assert found.proved[0].new_gains
    for delay, proved in (("[0, 2]", True), ("[0, 3]", False)):
        text = late().replace("[0, 5]", delay)
        assert (verdict(tmp_path, text, 1) is Verdict.PROVED) is proved


@pytest.mark.nightly
def test_the_loss_of_contact(tmp_path):
    found = blocked(tmp_path, soft("20", "50"), 4)
    assert "contact: with kept, where the spec asks losable (write `contact: kept`)" in texts(found)
    ranges = next(text for text in texts(found) if "stiffness" in text)
    assert re.search(r"up to 4[5-8](\.\d+)? N\*m/rad, where the spec asks 50 N\*m/rad", ranges)


@pytest.mark.nightly
def test_a_range_of_the_hand(tmp_path):
    found = blocked(tmp_path, hand(), 8)
    lines = {item.lines[0].line: item.lines[0] for item in found.proved}
    damping = lines["environments.hand.damping.range"]
    assert damping.word == "down to"
    # The example is proved from 4 on; with more work, 1.8 is.
    assert Fraction(3, 2) < Fraction(damping.proved.split(" ")[0]) < 5
    text = hand().replace("[1.5 N*m*s/rad", f"[{damping.proved}")
    assert verdict(tmp_path, text, 1) is Verdict.PROVED


@pytest.mark.slow
def test_another_loop_takes_other_things_for_granted(tmp_path):
    found = blocked(tmp_path, LATE, 20)
    delay, *_ = found.proved
    (line,) = delay.lines
    assert (line.line, line.word, line.proved) == ("sampling.delay", "with", "2 samples")
    assert "The law uses a force sample that is 2 samples old." in delay.needs
    head, first, *_ = blocked_lines(found, Path("a.nrs.yaml"))
    assert head.endswith("bounds under disturbances were not looked for")
    assert f"takes {len(delay.needs)} things more for granted (--json)" in first
    assert verdict(tmp_path, LATE.replace("delay: 4", line.write), 8) is Verdict.PROVED


@pytest.mark.slow
def test_a_dwell_time(tmp_path):
    found = blocked(tmp_path, PAIR, 2)
    (line,) = found.proved[0].lines
    assert (line.line, line.asked) == ("switching.dwell_time", "2.73 s")
    dwell = Fraction(line.proved.removesuffix(" s"))
    assert Fraction("2.7508") < dwell < 3
    assert line.write == f"dwell_time: {line.proved}"
    assert texts(found)[1:] == ["without modes[0] (stiff)", "without modes[1] (soft)"]
    # What is proved is the file with the line that is advised.
    path = spec_in(tmp_path, PAIR.replace("2.73 s", line.proved), "c")
    assert read_spec(path).sha256 == found.proved[0].sha256


@pytest.mark.slow
def test_arbitrary_switching(tmp_path):
    """Dayawansa and Martin 1999: stable, but only a polynomial of high degree shows it."""
    found = blocked(tmp_path, HARD, 1)
    (line,) = found.proved[0].lines
    assert (line.line, line.asked) == ("switching", "arbitrary")
    assert line.write == f"switching: {{{line.proved}}}"
    text = HARD.replace("arbitrary", f"{{{line.proved}}}")
    assert verdict(tmp_path, text, 1) is Verdict.PROVED


@pytest.mark.slow
def test_a_parameter_of_given_matrices(tmp_path):
    found = blocked(tmp_path, OSCILLATOR, 1)
    (line,) = found.proved[0].lines
    assert (line.line, line.word, line.asked) == ("parameters.k.range", "up to", "6.98")
    assert Fraction("3.82") <= Fraction(line.proved) < Fraction("6.98")
    constant = next(item for item in found.proved if item.lines[0].line.endswith("varies"))
    assert line_text(constant.lines[0]) == (
        "parameters.k.varies: with false, where the spec asks true (write `varies: false`)"
    )


@pytest.mark.slow
def test_nothing_helps_against_a_spring_that_is_too_stiff(tmp_path):
    text = (ROOT / "docs/examples/pulling.nrs.yaml").read_text(encoding="utf-8")
    text = text.replace("58 N*m/rad", "900 N*m/rad").replace("delay: 2", "delay: 0")
    found = blocked(tmp_path, text, 2)
    assert found.proved == ()
    (line,) = blocked_lines(found, Path("a"))
    assert line.startswith("no change found that is proved: 1 line of the spec was tried")


@pytest.mark.slow
def test_calmer_gains_of_all_controllers_come_first(tmp_path):
    text = spec_text("useless").replace("{min: 7 N*m*s/rad, max: 20 N*m*s/rad}", "2 N*m*s/rad")
    text = text.replace("600 N/m", "{nominal: 600 N/m, range: [300 N/m, 900 N/m]}")
    text = text.replace("0.015 rad", "0.06 rad") + "sampling: {period: 2 ms, delay: [0, 3]}\n"
    gains, *others = blocked(tmp_path, text, 4).proved
    # The force gain may stay as it is.
    assert [line.write for line in gains.lines] == ["Bt: 4 N*m*s/rad"] * 2
    assert not gains.new_gains
    assert others
    assert verdict(tmp_path, text.replace("Bt: 2 N", "Bt: 4 N"), 4) is Verdict.PROVED


@pytest.mark.slow
def test_the_same_is_found_each_time(tmp_path):
    first, second = (blocked(tmp_path, OSCILLATOR, 0.5) for _ in range(2))
    assert first == second
    assert first.proved


@pytest.mark.parametrize("path", [COMMUTING, PRINT_ERROR])
def test_what_is_decided_has_no_cause(path):
    assert find_blocked(run_certification(read_spec(path))) is None


@pytest.mark.slow
def test_a_change_that_is_no_spec_is_no_finding(tmp_path):
    """Rules that name a controller forbid to leave it out."""
    found = blocked(tmp_path, PAIR.replace("2.73 s", "{stiff: 2.73 s, soft: 2.73 s}"), 0.5)
    assert (found.proved, found.tried, found.work) == ((), 2, 0)
