"""What Coq is given, what it accepts, and what it refuses."""

import re
import resource
import subprocess
from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest

from nrs_design.certificates.verify import verify
from nrs_design.errors import DesignError
from nrs_design.exporters import rendered
from nrs_design.exporters.export import Export
from nrs_design.proof.mode import Time
from tests.support import ROOT, program_named

SHIPPED = sorted(path.name.removesuffix(".cert.json") for path in ROOT.glob("reports/*.cert.json"))
# One of each shape, the smallest.
SHAPES = [
    "commuting",
    "dayawansa-martin-6",
    "soft-tissue",
    "soft-tissue-axes",
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
    """What Coq says of a file: exit code, output, and processor time in s."""
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


def test_a_comment_ends_where_it_should():
    certificate = certificate_of("commuting")
    odd = replace(certificate, spec_name='a*) Axiom b : False. (* "c')
    text = text_of(odd)
    head = text[: text.index("From Coq")]
    assert head.count("*)") == head.count("(*") == 1
    assert '"' not in head


def test_names_of_modes_that_are_alike_stay_apart():
    from nrs_design.exporters.proof_assistant.text import identifiers

    names = identifiers(["a-b", "a/b", "a.b", "a_b_2"])
    assert len(set(names.values())) == 4
    assert all(re.fullmatch(r"mode_\w+", name) for name in names.values())


@pytest.mark.parametrize("number", [0, -1, 2**30 - 1, 2**30, -(2**61) - 5, 3**80])
def test_long_integers_are_those_digits(number):
    from nrs_design.exporters.proof_assistant.text import long_integer

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


def better(certificate):
    """A certificate of a rate that the exact check refuses, and not by much."""
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
    """A form of another sign, and a mode that is another."""
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
    """One digit of the middle of each."""
    text = text_of(certificate_of("dayawansa-martin-6"))
    for witness in re.finditer(r"^Definition witness.*?\.\n", text, re.MULTILINE | re.DOTALL):
        digits = list(re.finditer(r"\(h([0-9A-F]) ", witness[0]))
        at = witness.start() + digits[len(digits) // 2].start(1)
        other = "1" if text[at] == "0" else "0"
        assert refused(f"{text[:at]}{other}{text[at + 1 :]}", tmp_path)
