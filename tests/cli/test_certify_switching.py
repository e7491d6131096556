"""`nrs-design certify-switching`, as a user types it."""

import json
import os
import subprocess
import sys
from fractions import Fraction
from itertools import count

import pytest

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.spec import read_spec
from tests.pipeline.test_blocked import LATE
from tests.simulation.interactions import SOFT, text_of
from tests.support import (
    COMMUTING,
    HARD,
    PRINT_ERROR,
    ROOT,
    SOFT_TISSUE,
    document_of,
    run,
    typed,
    write_spec,
)

EXAMPLES = ROOT / "specs" / "examples"
RANGES = EXAMPLES / "oscillator-range.nrs.yaml"
DWELL = EXAMPLES / "geromel-colaneri.nrs.yaml"
SIX = EXAMPLES / "dayawansa-martin-6.nrs.yaml"
CONSTANT = EXAMPLES / "unknown-constant.nrs.yaml"
WIDE = ROOT / "docs" / "examples" / "wide-range.nrs.yaml"


SHORT = """\
soft-tissue: PROVED
  decays with alpha >= 3.91583 1/s (time constant at most 256 ms) under any switching among 4 modes\
, contact may be lost
  takes 12 things for granted (-v); not modelled: other axes; sampling, delay, \
quantization, friction, saturation
"""


def test_proved(tmp_path):
    result = typed("certify-switching", SOFT_TISSUE, cwd=tmp_path, code=0)
    assert result.stdout == SHORT
    assert list(tmp_path.iterdir()) == [], "what gates a build is written by gate"
    long = run("certify-switching", SOFT_TISSUE, "-v", cwd=tmp_path).stdout
    assert "Every solution, with contact lost and made again" in long
    assert "taken for granted (nrs-design report says how to test each):" in long
    assert "common quadratic function: exists" in long


def test_inconclusive_leaves_no_file(tmp_path):
    write_spec(tmp_path / "eleven.nrs.yaml", *HARD)
    asked = ("eleven.nrs.yaml", "--budget", 0, "--out", "c.json", "-v")
    result = run("certify-switching", *asked, cwd=tmp_path, code=3)
    assert "given: INCONCLUSIVE: no proof, and no signal that grows" in result.stdout
    assert "not begun: the budget of 0 is used up (--budget)" in result.stdout
    assert not (tmp_path / "c.json").exists()


def test_inconclusive_with_a_remark_keeps_it(tmp_path):
    write_spec(tmp_path / "eleven.nrs.yaml", *HARD)
    asked = ("eleven.nrs.yaml", "--max-degree", 8, "--out", "c.json", "-v")
    result = run("certify-switching", *asked, cwd=tmp_path, code=3)
    assert "polynomial of degree 10: not tried: --max-degree is 8" in result.stdout
    assert "given: INCONCLUSIVE: no proof, and no signal that grows" in result.stdout
    assert "no common quadratic function exists" in result.stdout
    document = json.loads((tmp_path / "c.json").read_text())
    assert [item["kind"] for item in document["statements"]] == ["no-common-quadratic"]
    assert document["verdict"] == "inconclusive"


@pytest.mark.slow
def test_two_resets_from_one_mode_to_another(tmp_path):
    path = ROOT / "docs" / "examples" / "contact-either-way.nrs.yaml"
    run("report", path, "--out", "page.html", "-v", cwd=tmp_path, code=1)
    assert "reset 2 of 2 to contact" in (tmp_path / "page.html").read_text()


CORNERS = """\
kind: switched-system
name: corners
time: discrete
parameters:
  k: {nominal: "1/2", range: [0, "0.9"], varies: false}
  m: {nominal: 0, range: ["-0.95", "0.95"], varies: false}
modes: [{name: a, A: [[0, 1], ["-k", "m"]]}, {name: b, A: [[0, "0.9"], ["-k", "0.9*m"]]}]
switching: arbitrary
"""


def test_constants_are_the_difference_between_refuted_and_proved(tmp_path):
    path = tmp_path / "a.nrs.yaml"
    path.write_text(CORNERS)
    result = run("certify-switching", path, "-v", "--out", "c.json", cwd=tmp_path, code=0)
    assert "For every constant value of k and m in their ranges" in result.stdout
    run("verify", "c.json", path, "-v", cwd=tmp_path, code=0)
    path.write_text(CORNERS.replace(", varies: false", ""))
    run("verify", "c.json", path, "-v", cwd=tmp_path, code=1)
    assert "Repeating" in run("certify-switching", path, "-v", cwd=tmp_path, code=1).stdout


@pytest.mark.parametrize(
    ("method", "spec", "code", "verdict"),
    [
        ("auto", SIX, 0, "proved/impossible"),
        ("lmi", COMMUTING, 0, "proved/exists"),
        pytest.param("gradient", SIX, 3, "inconclusive/unknown", marks=pytest.mark.slow),
        ("obstruction", SIX, 3, "inconclusive/impossible"),
        ("mixture", WIDE, 3, "inconclusive/unknown"),
        ("period", WIDE, 1, "refuted/impossible"),
        ("polynomial", SIX, 0, "proved/unknown"),
        ("mode-quadratic", DWELL, 0, "proved/unknown"),
        ("constants-quadratic", CONSTANT, 0, "proved/unknown"),
        ("mixture", PRINT_ERROR, 1, "refuted/impossible"),
    ],
)
def test_every_method(tmp_path, method, spec, code, verdict):
    document = document_of("certify-switching", spec, "--method", method, cwd=tmp_path, code=code)
    assert f"{document['verdict']}/{document['common_quadratic']}" == verdict


@pytest.mark.parametrize(
    ("method", "spec"), [("constants-quadratic", SIX), ("mixture", DWELL), ("mixture", "discrete")]
)
def test_method_that_does_not_apply_is_wrong_usage(tmp_path, method, spec):
    if spec == "discrete":
        spec = write_spec(tmp_path / "d.nrs.yaml", [["1/2"]], time="discrete").path
    result = run("certify-switching", spec, "--method", method, cwd=tmp_path, code=2)
    assert f"error[NRS002]: the method {method} does not apply" in result.stderr
    assert "use --method auto" in result.stderr
    assert result.stdout == ""


@pytest.mark.slow
def test_margin_of_the_oscillator(tmp_path):
    """Zelentsovsky 1994: stable up to 6.98513, so no larger box can be proved."""
    arguments = ("certify-switching", RANGES, "--margin", "--max-degree", 6)
    margin = document_of(*arguments, cwd=tmp_path, code=0)["margin"]
    plain = run(*arguments, cwd=tmp_path)
    proved, refuted = (Fraction(margin[f"{end}_scale_exact"]) for end in ("proved", "refuted"))
    assert margin["proved_scale"] <= proved < refuted <= margin["refuted_scale"]
    assert f"largest box: scaled by {rounded_down(proved)} about" in plain.stdout
    assert f"scaled by {rounded_up(refuted)} they are refuted" in plain.stdout


@pytest.mark.slow
def test_shortest_dwell_time_of_a_pair_that_is_proved_at_30_s(tmp_path):
    """Never less than the verdict above it, nor a number that is rounded the wrong way."""
    (tmp_path / "pair.nrs.yaml").write_text(
        "kind: switched-system\nname: pair\ntime: continuous\nmodes:\n"
        '  - {name: a, A: [["-0.1", 1], [-1, "-0.1"]]}\n'
        '  - {name: b, A: [["-0.1", 10], ["-0.1", "-0.1"]]}\nswitching: {dwell_time: 30 s}\n'
    )
    arguments = ("pair.nrs.yaml", "--shortest-dwell", "--max-degree", 4)
    dwell = document_of("certify-switching", *arguments, cwd=tmp_path)["shortest_dwell"]
    assert (dwell["unit"], dwell["method"]) == ("s", "mode quadratic")
    assert Fraction(dwell["refuted_exact"]) < Fraction(dwell["proved_exact"]) < 12
    assert dwell["refuted"] <= Fraction(dwell["refuted_exact"])
    assert dwell["proved"] >= Fraction(dwell["proved_exact"])


def test_no_shortest_dwell_time_where_the_contact_may_change(tmp_path):
    """The contact changes when it likes, so no dwell time of the controller makes it wait."""
    law = "{type: impedance, environment: soft, contacts: [soft, stiff], Mt: 0 kg*m^2, "
    stiff = "{model: elastic, stiffness: 200 N*m/rad}"
    text = text_of({"c": law + "Bt: 1 N*m*s/rad}"}, {"soft": SOFT, "stiff": stiff})
    (tmp_path / "contacts.nrs.yaml").write_text(text)
    result = run("certify-switching", "contacts.nrs.yaml", "--shortest-dwell", cwd=tmp_path, code=2)
    # What is shown is kept, and told all the same.
    assert result.stdout.startswith("small: REFUTED")
    assert "a dwell time beside several contacts" in result.stderr
    # The same words refuse a dwell time in the spec.
    declared = text.replace("switching: arbitrary", "switching: {dwell_time: 1.2 s}")
    (tmp_path / "declared.nrs.yaml").write_text(declared)
    checked = run("check", "declared.nrs.yaml", cwd=tmp_path)
    assert "a dwell time beside several contacts" in checked.stderr


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["missing.nrs.yaml"], "no such file"),
        ([], "Missing argument"),
        ([str(COMMUTING), "--method", "guess"], "guess"),
        ([str(COMMUTING), "--unknown"], "--unknown"),
        ([str(COMMUTING), "--max-degree", "1"], "--max-degree"),
        ([str(COMMUTING), "--max-degree", "65"], "--max-degree"),
        ([str(COMMUTING), "--budget", "-1"], "--budget"),
        (["."], "directory"),
    ],
)
def test_wrong_usage(tmp_path, arguments, reason):
    result = run("certify-switching", *arguments, cwd=tmp_path, code=2)
    assert reason in result.stderr
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert not list(tmp_path.iterdir())


def test_json(tmp_path):
    document = document_of(
        "certify-switching", SOFT_TISSUE, "--out", "c.json", cwd=tmp_path, code=0
    )
    certificate = json.loads((tmp_path / "c.json").read_text())
    (statement,) = certificate["statements"]
    wanted = {
        "decay_rate_exact": statement["rate"],
        "modes": [mode["name"] for mode in certificate["modes"]],
        "gains": certificate["gains"],
        "certificate": "c.json",
        "certificate_id": certificate["id"],
        "spec_sha256": read_spec(SOFT_TISSUE).sha256,
    }
    assert {name: document[name] for name in wanted} == wanted
    # The answer says in words what the certificate holds as data.
    assert "claim" not in statement
    granted = [*certificate["assumptions"], certificate["contact"]["loss"]]
    assert len(document["assumptions"]) == len(granted)
    assert granted[-1] == {"id": "contact-lost.surface"}
    assert document["assumptions"][-1].startswith("Contact is lost where the deflection")
    assert document["decay_rate"] <= document["decay_rate_limit"]


def test_a_clock_that_stops_the_search_is_said_and_nothing_is_decided(tmp_path, monkeypatch):
    ticks = count()
    monkeypatch.setattr("nrs_design.work.monotonic", lambda: 100.0 * next(ticks))
    said = "the clock stopped this after 660 s, before its budget of work was used up"
    for options in ((), ("--json",)):
        result = run("certify-switching", COMMUTING, *options, cwd=tmp_path, code=3)
        assert f"error[NRS008]: {said}" in " ".join(result.stderr.split())
        assert "PROVED" not in result.stdout
    document = json.loads(result.stdout)
    assert document["rule"] == "NRS008"
    assert document["faults"][0]["message"].startswith(said)
    assert not (tmp_path / "reports").exists()


def test_work_is_counted_alike_in_every_run(tmp_path):
    found = [document_of("certify-switching", COMMUTING, cwd=tmp_path) for _ in range(2)]
    one, other = ({a["step"]: a["work"] for a in each["attempts"]} for each in found)
    assert one == other
    assert one["lmi"] > 0


@pytest.mark.slow
def test_the_default_degree_follows_the_budget(tmp_path):
    pair = [[-1, -1], [1, -1]], [[-1, "-10.95"], ["20/219", -1]]
    write_spec(tmp_path / "high.nrs.yaml", *pair)
    document = document_of("certify-switching", "high.nrs.yaml", cwd=tmp_path, code=0)
    assert int(document["method"].removeprefix("polynomial of degree ")) > 12


@pytest.mark.slow
def test_a_spec_says_how_far_the_search_goes_and_options_override_it(tmp_path):
    path = write_spec(tmp_path / "eleven.nrs.yaml", *HARD).path
    path.write_text(path.read_text() + "certification: {max_degree: 4, budget: 20}\n")
    result = run("certify-switching", path, "-v", cwd=tmp_path)
    assert "polynomial of degree 6: not tried: --max-degree is 4" in result.stdout
    result = run("certify-switching", path, "--max-degree", 2, "-v", cwd=tmp_path)
    assert "polynomial of degree 4: not tried: --max-degree is 2" in result.stdout
    result = run("gate", path, "--no-reports", "-v", cwd=tmp_path, code=3)
    assert "not tried: --max-degree is 4" in result.stdout


@pytest.mark.slow
def test_options_of_the_search_are_those_of_a_report_and_of_memory_too(tmp_path):
    path = write_spec(tmp_path / "eleven.nrs.yaml", *HARD).path
    result = run("report", path, "--max-degree", 2, "-v", cwd=tmp_path, code=3)
    result = run("certify-switching", path, "--memory", "1e-9", "-v", cwd=tmp_path)
    assert "GB are allowed (--memory)" in result.stdout


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("{max_degree: 7}", "7 is not an even integer from 2 to 64"),
        ("{max_degree: 66}", "66 is not an even integer from 2 to 64"),
        ("{budget: 1e9}", "1e9 is not above 0 and at most 600"),
        ("{budget: 0}", "0 is not above 0 and at most 600"),
        ("{budget: 60 s}", "is a time, and a budget counts work"),
        ("{budget: a lot}", "budget"),
        ("{memory: 1 GB}", "memory"),
    ],
)
def test_limits_of_the_search_that_a_spec_may_not_say(tmp_path, section, words):
    path = write_spec(tmp_path / "eleven.nrs.yaml", *HARD).path
    path.write_text(path.read_text() + f"certification: {section}\n")
    assert words in run("check", path, cwd=tmp_path, code=2).stderr


def test_every_step_is_listed_and_no_color_is_in_a_pipe(tmp_path):
    environment = {"FORCE_COLOR": "1", "NO_COLOR": "1"}
    result = typed("certify-switching", COMMUTING, "-v", cwd=tmp_path, environment=environment)
    assert "\x1b" not in result.stdout + result.stderr
    assert "suspicious modes: none" in result.stdout
    assert "lmi: found" in result.stdout


def broken_pipe():
    read, write = os.pipe()
    os.close(read)
    return write


@pytest.mark.parametrize(
    ("opened", "code", "said"),
    [
        # Who reads changes nothing: the system is proved, and its certificate is written.
        (broken_pipe, 0, "certificate written to c.json\n"),
        (lambda: os.open("/dev/full", os.O_WRONLY), 2, "the output cannot be written"),
    ],
)
def test_output_that_nobody_takes(tmp_path, opened, code, said):
    written, asked = opened(), ("certify-switching", str(COMMUTING), "--out", "c.json")
    done = subprocess.run(
        [*(sys.executable, "-m", "nrs_design"), *asked],
        stdout=written,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    os.close(written)
    assert done.returncode == code
    assert said in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "spec", "closed"),
    [("certify-switching", COMMUTING, ">&- 2>&-"), ("tune", SOFT_TISSUE, ">&-")],
)
def test_closed_streams(tmp_path, command, spec, closed):
    line = f'exec "$0" -m nrs_design {command} "$1" {closed}'
    result = subprocess.run(
        ["sh", "-c", line, sys.executable, str(spec)],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert result.returncode == 0
    assert "internal error" not in result.stderr


def test_dwell_time_in_steps_is_proved_or_refuted(tmp_path):
    """Powers of two shears: up to four steps in each mode they grow, from five on they do not."""
    for steps, code, said in ((4, 1, "m1 for 4 steps"), (5, 0, "at least 5 steps in each mode")):
        path = tmp_path / "steps.nrs.yaml"
        path.write_text(
            "kind: switched-system\nname: steps\ntime: discrete\nmodes:\n"
            '  - {name: m0, A: [["1/2", 2], [0, "1/2"]]}\n'
            '  - {name: m1, A: [["1/2", 0], [2, "1/2"]]}\n'
            f"switching: {{dwell_time: {steps} steps}}\n"
        )
        asked = ("certify-switching", path.name, "-v", "--out", "c.json")
        assert said in run(*asked, cwd=tmp_path, code=code).stdout
        run("verify", "c.json", path.name, "-v", cwd=tmp_path, code=code)


class TestGradientOptions:
    @pytest.mark.slow
    def test_the_rate_is_optimized_and_the_way_is_told(self, tmp_path):
        """The LMI proves 3.914 1/s for this pair, and the iteration alone without it 1.2."""
        arguments = ("certify-switching", SOFT_TISSUE, "--method", "gradient", "--json")
        done = run(*arguments, "--set", "order=random", "--set", "seed=3", cwd=tmp_path, code=0)
        document = json.loads(done.stdout)
        assert 3.6 < document["decay_rate"] < 3.92
        history = document["gradient_history"]
        assert [step for step, _ in history] == list(range(len(history)))
        assert history[-1][1] <= 0 < history[0][1]

    def test_the_states_as_given_lead_nowhere(self, tmp_path):
        options = ("--set", "coordinates=given")
        few = ("--set", "max_updates=500", "-v")
        arguments = ("certify-switching", SOFT_TISSUE, "--method", "gradient", *options, *few)
        done = run(*arguments, cwd=tmp_path, code=3)
        assert "gradient: not converged after 500 updates" in done.stdout

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (
                ("--method", "lmi", "--set", "radius=2"),
                "lmi has no use for settings of the gradient",
            ),
            (("--method", "gradient", "--set", "start=m9"), "cannot start with mode 'm9'"),
            (("--method", "gradient", "--set", "radius=0"), "cannot run with radius 0.0"),
            (("--set", "radus=2"), "is no setting of the gradient iteration"),
            (("--set", "radius=x"), "'x' is no value of radius"),
        ],
    )
    def test_settings_that_make_no_sense(self, tmp_path, options, message):
        assert message in run("certify-switching", COMMUTING, *options, cwd=tmp_path, code=2).stderr


def test_a_bound_that_is_missing_is_said(tmp_path):
    """The spec asks for one, and the memory that is allowed does not take the search."""
    text = f"{SOFT_TISSUE.read_text(encoding='utf-8')}\ndisturbances: {{command: 8 deg/s}}\n"
    (tmp_path / "commanded.nrs.yaml").write_text(text)
    result = run(
        "certify-switching", "commanded.nrs.yaml", "--memory", "0.00005", cwd=tmp_path, code=0
    )
    assert "bound on force under velocity command: not tried" in result.stdout
    assert "conewise quadratic: " not in result.stdout


@pytest.mark.parametrize(("wanted", "ends"), [("0.5 1/s", "met"), ("300 1/s", "NOT PROVED")])
def test_goals_of_the_proof_are_said_where_it_is(tmp_path, wanted, ends):
    """The verdict is about stability alone, and so is the exit code."""
    path = tmp_path / "wanting.nrs.yaml"
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    path.write_text(f"{text}goals: {{decay_rate: {wanted}}}\n", encoding="utf-8")
    done = run("certify-switching", path, cwd=tmp_path, code=0)
    assert f"  goal decay_rate, {wanted}: {ends}: the proved decay rate is 3.91583" in done.stdout
    told = document_of("certify-switching", path, cwd=tmp_path)
    (goal,) = told["goals"]
    assert (goal["goal"], goal["wanted"], goal["proved"]) == ("decay_rate", wanted, ends == "met")
    said = run("tune", path, cwd=tmp_path).stdout
    assert "Not judged here: decay_rate. A proof decides: nrs-design certify-switching." in said


AT_ONCE = ROOT / "docs" / "examples" / "tissue-and-tool-at-once.nrs.yaml"


def test_tissue_and_tool_touched_at_once(tmp_path):
    """Thesis 6.1 and 6.3.2: 104.7 N m/rad is beyond the 75.9 of the withdrawal."""
    result = run("certify-switching", AT_ONCE, "-v", cwd=tmp_path, code=1)
    assert "104.696 N*m/rad stiff, and its gains hold less than 75.9465" in result.stdout
    more = tmp_path / "more.nrs.yaml"
    text = AT_ONCE.read_text().replace("name: tissue-and-tool-at-once", "name: more")
    more.write_text(text.replace("Bt: 1.04 N*m*s", "Bt: 2.15 N*m*s"))
    told = document_of("certify-switching", more, cwd=tmp_path)
    assert (told["verdict"], told["relief"]) == ("proved", [])
    assert told["modes"] == ["withdrawal/soft+stiff/k-min", "withdrawal/soft+stiff/k-max"]


@pytest.mark.slow
def test_an_open_verdict_says_which_lines_block_it(tmp_path):
    """Old samples and a disturbance: `check` takes them, and nobody has to ask."""
    path = tmp_path / "late.nrs.yaml"
    path.write_text(LATE, encoding="utf-8")
    run("check", path, "-v", cwd=tmp_path, code=0)
    said = run("certify-switching", path, "-v", cwd=tmp_path, code=3).stdout
    assert said.startswith("soft-tissue: INCONCLUSIVE")
    _, listed = said.split("  proved with any one of these changes; ")
    assert "late.nrs.yaml:56: sampling.delay: with 2 samples" in listed
    assert "late.nrs.yaml:44: without controllers.withdrawal" in listed
    assert "bounds under disturbances were not looked for" in " ".join(listed.split())
    told = document_of("certify-switching", path, cwd=tmp_path)
    delay, alone = told["blocked_by"][:2]
    (line,) = delay["lines"]
    assert line["place"].endswith("late.nrs.yaml:56:26")
    assert line["asked"] == "4 samples"
    assert line["write"] == "delay: 2"
    assert "The law uses a force sample that is 2 samples old." in delay["assumptions_besides"]
    assert alone["lines"][0]["line"] == "controllers.withdrawal"
    assert told["lines_work"] < 30
    # What is advised is proved by the command.
    path.write_text(LATE.replace("delay: 4", line["write"]))
    assert run("certify-switching", path, "--no-optimize-rate", "-v", cwd=tmp_path, code=0).stdout


def test_the_growth_per_step_is_said_whatever_the_verdict(tmp_path):
    """Philippe et al. 2016: 0.97482, and forms with a memory; one rung alone decides nothing."""
    lossy = ROOT / "docs" / "examples" / "lossy-network.nrs.yaml"
    alone = ("--method", "mode-quadratic", "--max-degree", "4", "--out", "a.cert.json")
    result = typed("certify-switching", lossy, *alone, "-v", cwd=tmp_path, code=3)
    wanted = "growth per step, rho: at least 0.974817 (rounded down), by n1, n3, n1, n2, n3 4 times"
    assert wanted in result.stdout
    assert "at most 0.97499" in result.stdout
    assert " % apart" in result.stdout
