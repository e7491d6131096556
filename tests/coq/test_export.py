"""What Coq is given, what it accepts, and what it refuses."""

import re
import resource
import subprocess
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

from nrs_design.certificates.verify import verify
from nrs_design.errors import DesignError
from nrs_design.exporters import format_of, rendered
from nrs_design.exporters.export import Export
from nrs_design.exporters.write import places
from nrs_design.proof.evidence.graph import Arc
from nrs_design.proof.mode import Time
from nrs_design.search.certify import Limits, certify
from tests.search.support import thesis_robot
from tests.support import ROOT, program_named

SHIPPED = sorted(path.name.removesuffix(".cert.json") for path in ROOT.glob("reports/*.cert.json"))
# A constant parameter has no theorem.
SHIPPED.remove("unknown-constant")
# One of each shape, the smallest.
SHAPES = [
    "commuting",
    "dayawansa-martin-6",
    "soft-tissue",
    "force-limit-sampled",
    "force-limit-offset",
    "failing-controller",
]
# Ten seconds of one core, were it not for what else a machine does.
HANG = 60
# Those of the real numbers of Coq's library.
STANDARD = {
    "ClassicalDedekindReals.sig_not_dec",
    "ClassicalDedekindReals.sig_forall_dec",
    "FunctionalExtensionality.functional_extensionality_dep",
}


@cache
def certificate_of(name):
    checked = verify(ROOT / f"reports/{name}.cert.json")
    assert checked.fault is None
    return checked.certificate


def text_of(certificate):
    return rendered("coq", Export("proved", None, certificate))[".v"].decode()


def told(text, folder):
    (folder / "statement.v").write_text(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(
        [program_named("coqc"), "statement.v"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    taken = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    return done.returncode, done.stdout + done.stderr, taken


def with_evidence(certificate, **changes):
    first, *others = certificate.statements
    return replace(certificate, statements=(replace(first, **changes), *others))


def refused(text, folder):
    """Tell whether Coq refuses a file where the certificate is computed, and nowhere else."""
    code, output, _ = told(text, folder)
    line = int(re.search(r'"\./statement\.v", line (\d+)', output)[1]) if code else 0
    return code == 1 and text.splitlines()[line - 1].startswith("Proof. vm_cast_no_check")


@pytest.mark.parametrize("name", SHAPES)
def test_the_theorem_names_every_mode(name):
    certificate = certificate_of(name)
    text = text_of(certificate)
    theorem = text[text.index("Theorem stable") :]
    evidence, system = certificate.evidence, certificate.system
    modes = [*system.modes, *(system.free if evidence.covers_lost_contact else ())]
    names = re.findall(r"mode_\w+", theorem)
    assert len(set(names)) == len(names) == len(modes)
    for mode in modes:
        assert f"(* {mode.name} *)" in text
    assert text == text_of(certificate)


def lists_of(text, name):
    """The lists of a definition, each a list of integers; names of lists are looked up."""
    rows = dict(re.findall(r"^Definition (v\d+) := \[(.*?)\]\.$", text, re.MULTILINE))
    body = re.search(rf"^Definition {name} := (.*?)\.$", text, re.MULTILINE)[1]
    found = re.sub(r"v\d+", lambda match: f"[{rows[match[0]]}]", body)
    return [list(map(int, row.split("; "))) for row in re.findall(r"\[(-?\d[^][]*)\]", found)], body


def test_the_modes_are_those_of_the_certificate():
    """Coq cannot tell; the deflection, which is the last state, comes first."""
    certificate = certificate_of("soft-tissue")
    text, system = text_of(certificate), certificate.system
    names = re.findall(r"^Definition (mode_\w+)", text, re.MULTILINE)
    for name, mode in zip(names, [*system.modes, *system.free], strict=True):
        rows, body = lists_of(text, name)
        over = int(re.search(r"\] (\d+) \[", body)[1])
        found = [[Fraction(entry, over) for entry in row] for row in rows]
        A = mode.A.fractions()
        assert found == [[A[i][j] for j in (3, 0, 1, 2)] for i in (3, 0, 1, 2)]


def test_the_modes_of_a_sampled_loop_are_those_of_the_certificate():
    certificate = certificate_of("soft-tissue-sampled")
    text, system = text_of(certificate), certificate.system
    names = re.findall(r"^Definition (mode_\w+)", text, re.MULTILINE)
    n, errors = system.order, system.roundings
    order = [n - 1, *range(n - 1)]
    for k, (name, mode) in enumerate(zip(names, [*system.modes, *system.free], strict=True)):
        before = order if k < len(system.modes) else order[1:]
        (units, *columns), _ = lists_of(text, name)
        columns, bounds = columns[: len(units)], columns[len(units) :]
        A = mode.A.fractions()
        expected = [[A[i][j] for i in order] for j in before]
        expected += [[item.columns[k].fractions()[i][0] for i in order] for item in errors]
        found = [
            [Fraction(entry, unit) for entry in column]
            for unit, column in zip(units, columns, strict=True)
        ]
        assert found == expected
        rows = [item.rows[k].fractions()[0] for item in errors]
        assert [
            [Fraction(entry, unit) for entry, unit in zip(bound, units, strict=False)]
            for bound in bounds
        ] == [[row[j] for j in before] for row in rows]


def test_a_comment_ends_where_it_should():
    certificate = certificate_of("commuting")
    odd = replace(certificate, spec_name='a*) Axiom b : False. (* "c')
    text = text_of(odd)
    head = text[: text.index("From Coq")]
    assert head.count("*)") == head.count("(*") == 1
    assert '"' not in head


def test_kinds_and_shapes_without_a_theorem_are_refused():
    certificate = certificate_of("dayawansa-martin-6")
    refuted = replace(certificate, statements=certificate.statements[1:])
    with pytest.raises(DesignError, match="shown by nothing"):
        text_of(refuted)
    with pytest.raises(DesignError, match="shown by kind constants-quadratic"):
        text_of(certificate_of("unknown-constant"))
    certificate = certificate_of("force-limit-sampled")
    arcs = (Arc(target=0), Arc(source=0))
    with pytest.raises(DesignError, match="some of the forms"):
        text_of(with_evidence(certificate, edges=arcs))


def test_a_name_is_one_of_coq():
    (path,) = places(format_of("coq"), "3-axes.b", Path()).values()
    assert path.name == "_3_axes_b.v"


def test_names_of_modes_that_are_alike_stay_apart():
    from nrs_design.coq.text import identifiers

    names = identifiers(["a-b", "a/b", "a.b", "a_b_2"])
    assert len(set(names.values())) == 4
    assert all(re.fullmatch(r"mode_\w+", name) for name in names.values())


@pytest.mark.parametrize("number", [0, -1, 2**30 - 1, 2**30, -(2**61) - 5, 3**80])
def test_long_integers_are_those_digits(number):
    from nrs_design.coq.text import long_integer

    text = long_integer(number)
    if re.fullmatch("-?[0-9]+", text):
        assert int(text) == number
        return
    value = 1
    for digit in reversed(re.findall(r"h([0-9A-F])|x([OI])", text)):
        value = 16 * value + int(digit[0], 16) if digit[0] else 2 * value + "OI".index(digit[1])
    assert value * (-1 if "Zneg" in text else 1) == number


def test_what_is_not_covered_is_refused_with_what_is():
    certificate = certificate_of("soft-tissue")
    contact = replace(certificate.system.contact, pulls=(replace(certificate.system.modes[0].A),))
    odd = replace(certificate, system=replace(certificate.system, contact=contact))
    with pytest.raises(DesignError, match="could pull") as caught:
        text_of(odd)
    assert "conewise-quadratic" in str(caught.value)


@pytest.mark.nightly
@pytest.mark.parametrize("name", SHIPPED)
def test_coq_accepts_every_shipped_proof(name, tmp_path):
    code, output, taken = told(text_of(certificate_of(name)), tmp_path)
    assert code == 0, output
    assert set(re.findall(r"^([A-Z]\w+\.\w+)", output, re.MULTILINE)) <= STANDARD
    assert taken < HANG


@pytest.mark.nightly
def test_coq_accepts_one_function_for_each_mode(tmp_path):
    """Contact is lost, and the forms in contact and free are several."""
    sampling = "{period: 2 ms, delay: 2}"
    system = thesis_robot(
        ("20", "42.5"), ("2.15", "1.04"), "0.01", sampling=sampling, contact="losable"
    )
    evidence = certify(system, limits=Limits(optimize_rate=False)).evidence
    assert len(evidence.nodes) > 2
    one = certificate_of("soft-tissue-sampled")
    certificate = replace(one, system=system, statements=(evidence,))
    code, output, _ = told(text_of(certificate), tmp_path)
    assert code == 0, output
    assert refused(text_of(better(certificate)), tmp_path)


def better(certificate):
    evidence, system = certificate.evidence, certificate.system
    share = Fraction(1, 4096)
    rate = evidence.rate
    while True:
        faster = rate * (1 + share) if system.time is Time.CONTINUOUS else rate - share * (1 - rate)
        changed = with_evidence(certificate, rate=faster)
        if changed.statements[0].find_fault(system) is not None:
            return changed
        share *= 2


@pytest.mark.nightly
@pytest.mark.parametrize("name", SHAPES)
def test_coq_refuses_a_better_rate(name, tmp_path):
    assert refused(text_of(better(certificate_of(name))), tmp_path)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["soft-tissue", "failing-controller", "force-limit-sampled"])
def test_coq_refuses_numbers_that_are_altered(name, tmp_path):
    certificate = certificate_of(name)
    text = text_of(certificate)
    begin = re.compile(r"(Definition form := |Node |Place .*\n +)\[\((?=\d)")
    assert refused(begin.sub(r"\1[(-", text, count=1), tmp_path)
    first, *others = certificate.system.modes
    numerators = [[2 * entry for entry in row] for row in first.A.numerators]
    A = replace(first.A, numerators=tuple(map(tuple, numerators)))
    system = replace(certificate.system, modes=(replace(first, A=A), *others))
    odd = text_of(replace(certificate, system=system))
    # The witnesses stay those of the certificate.
    witnesses = re.compile(r"^Definition witness.*?\.\n", re.MULTILINE | re.DOTALL)
    kept = iter(witnesses.findall(text))
    assert refused(witnesses.sub(lambda _: next(kept), odd), tmp_path)


@pytest.mark.nightly
def test_coq_refuses_an_altered_witness(tmp_path):
    text = text_of(certificate_of("dayawansa-martin-6"))
    for witness in re.finditer(r"^Definition witness.*?\.\n", text, re.MULTILINE | re.DOTALL):
        digits = list(re.finditer(r"\(h([0-9A-F]) ", witness[0]))
        at = witness.start() + digits[len(digits) // 2].start(1)
        other = "1" if text[at] == "0" else "0"
        assert refused(f"{text[:at]}{other}{text[at + 1 :]}", tmp_path)
