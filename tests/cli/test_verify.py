"""`nrs-design verify`, as a user types it."""

import json
import shutil
import subprocess
import sys

import pytest

from nrs_design.certificates.certificate import content_id
from tests.support import (
    COMMUTING,
    HARD,
    PRINT_ERROR,
    ROBOT,
    SOFT_TISSUE,
    document_of,
    run,
    typed,
    write_spec,
)


@pytest.fixture(scope="module")
def certified(tmp_path_factory):
    folder = tmp_path_factory.mktemp("certified")
    for spec in (SOFT_TISSUE, PRINT_ERROR, COMMUTING):
        name = spec.name.removesuffix(".nrs.yaml")
        run("certify-switching", spec, "--out", f"{name}.json", cwd=folder)
    return folder


def test_proof_holds(certified):
    result = typed("verify", "soft-tissue.json", SOFT_TISSUE, "-v", cwd=certified, code=0)
    assert result.stdout.startswith("PROVED for this spec, checked exactly")
    assert "insertion: Mt = 0.00999999977648258209228515625 kg*m^2, Bt = 2.15" in result.stdout
    said = "as recorded, within what the spec allows, not designed again (gate does): insertion Mt,"
    assert said in result.stdout


def test_the_derivative_gain_is_that_of_a_program(tmp_path):
    """It multiplies by Kd/T, rounded to single precision; at 3 ms that is another Kd."""
    text = (ROBOT / "force-limit-sampled.nrs.yaml").read_text().replace("2 ms", "3 ms")
    (tmp_path / "slow.nrs.yaml").write_text(text)
    run("certify-switching", "slow.nrs.yaml", "--out", "c.json", "-v", cwd=tmp_path, code=0)
    shown = run("verify", "c.json", "slow.nrs.yaml", "-v", cwd=tmp_path, code=0).stdout
    assert "Kd = 2060 rpm*s/rad" in shown
    assert "multiplies by Kd/T = 686666.6875 rpm/rad, which makes its Kd about 2060.000062" in shown


@pytest.mark.parametrize(
    ("name", "code", "verdict"),
    [
        ("soft-tissue", 0, "PROVED"),
        ("thesis-print-error", 1, "REFUTED"),
        ("commuting", 0, "PROVED"),
    ],
)
def test_without_a_spec_the_proof_is_checked_and_no_more(certified, name, code, verdict):
    first, *_ = run("verify", f"{name}.json", cwd=certified, code=code).stdout.splitlines()
    said = "for the modes in the file, checked exactly; name a SPEC to compare them with"
    assert first == f"{verdict} {said}"
    document = document_of("verify", f"{name}.json", cwd=certified)
    assert (document["verdict"], document["spec"]) == (verdict.lower(), None)


def test_without_a_spec_what_is_altered_is_rejected(certified, tmp_path):
    document = json.loads((certified / "commuting.json").read_text())
    document["modes"][0]["numerators"][0][0] *= -1
    (tmp_path / "c.json").write_text(json.dumps(document))
    found = document_of("verify", "c.json", COMMUTING, cwd=tmp_path, code=1)
    assert (found["verdict"], "altered" in found["fault"]) == ("rejected", True)
    assert found["claims"] is found["gains"] is found["certificate_id"] is None
    assert "REJECTED: its content" in run("verify", "c.json", cwd=tmp_path).stdout
    document["id"] = content_id(document)
    (tmp_path / "c.json").write_text(json.dumps(document))
    assert "REJECTED: V does not decrease" in run("verify", "c.json", cwd=tmp_path, code=1).stdout


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("thesis-print-error.json", PRINT_ERROR), 1, "REFUTED for this spec"),
        (("soft-tissue.json", COMMUTING), 1, "REJECTED: it belongs to another spec"),
        (("soft-tissue.json", PRINT_ERROR), 1, "REJECTED: it belongs to another spec"),
        (("commuting.json", "none.nrs.yaml"), 2, "error[NRS001]"),
        (("commuting.json", COMMUTING, "--deployed", "x.h"), 2, "no gains that could be deployed"),
    ],
)
def test_what_is_no_proof_of_the_spec_says_why(certified, arguments, code, said):
    result = run("verify", *arguments, cwd=certified, code=code)
    assert said in (result.stderr if code == 2 else result.stdout)


def test_remark_that_decides_nothing(tmp_path):
    """It holds, and says so, but is no verdict: exit code 3."""
    spec = write_spec(tmp_path / "hard.nrs.yaml", *HARD).path
    run("certify-switching", spec, "--max-degree", 2, "--out", "c.json", "-v", cwd=tmp_path, code=3)
    result = run("verify", "c.json", spec, "-v", cwd=tmp_path, code=3)
    assert result.stdout.startswith("INCONCLUSIVE for this spec, checked exactly")
    assert "does not exist. This alone says nothing about stability." in result.stdout


@pytest.mark.parametrize("content", [None, b"", b"[]", b'{"a": NaN}', b"[" * 9000, b"9" * 5000])
def test_not_a_certificate(tmp_path, content):
    if content is not None:
        (tmp_path / "c.json").write_bytes(content)
    result = run("verify", "c.json", COMMUTING, cwd=tmp_path, code=2)
    assert result.stderr.startswith("error[NRS004]: c.json")
    assert result.stdout == ""


def test_disagreement_is_an_internal_error(certified):
    """Flint says no where the integer check says yes: exit code 4 and no verdict."""
    program = (
        "import sys; from nrs_design.certificates import second_opinion as s; "
        "s.has_positive_spectrum = lambda M: False; "
        "sys.argv = ['nrs-design', *sys.argv[1:]]; from nrs_design.cli import main; main()"
    )
    for arguments in (["verify", "commuting.json", COMMUTING], ["certify-switching", COMMUTING]):
        result = subprocess.run(
            [sys.executable, "-c", program, *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=certified,
            check=False,
        )
        assert result.returncode == 4
        assert "InternalError" in result.stderr
        assert "PROVED" not in result.stdout
    assert not (certified / "reports").exists()


@pytest.fixture(scope="module")
def firmware(tmp_path_factory):
    """Insertion every 2 ms, exported in every format that is compared and as a record, into x."""
    folder = tmp_path_factory.mktemp("deployed")
    head, _, _ = SOFT_TISSUE.read_text().partition("  withdrawal:")
    sampling = "switching: arbitrary\nsampling: {period: 2 ms, delay: 0}\n"
    (folder / "x.nrs.yaml").write_text(head.replace("name: soft-tissue", "name: x") + sampling)
    run("export", "x.nrs.yaml", "--out", "x", "-q", "--format", "c", cwd=folder, code=0)
    again = ("export", "x.nrs.yaml", "--out", "x", "-q", "--certificate", "x/x.cert.json")
    for name in ("json", "vectors", "monitor", "cmake", "fmu"):
        run(*again, "--format", name, cwd=folder, code=0)
    return folder


@pytest.fixture
def deployed(firmware, tmp_path):
    return shutil.copytree(firmware, tmp_path / "deployed")


CHECK = ("verify", "x/x.cert.json", "x.nrs.yaml", "--deployed")


def test_deployed_files_are_those_of_the_certificate(deployed):
    for name in ("x.h", "x_test.c", "x.fmu"):
        first = run(*CHECK, f"x/{name}", cwd=deployed, code=0).stdout.splitlines()[0]
        assert first.startswith(f"deployed: x/{name}: as exported with the certificate, byte for")
        assert first.endswith("; not compared: how it is compiled")
    first = run(*CHECK, "x", cwd=deployed, code=0).stdout.splitlines()[0]
    assert first.startswith("deployed: 11 files of x: as exported")
    assert first.endswith("; not compared: how it is compiled, x.export.json")
    text = (deployed / "x/x.h").read_text()
    assert text.count("0x1.f6eep+19F") == 1
    (deployed / "x/x.h").write_text(text.replace("0x1.f6eep+19F", "0x1.f6ee02p+19F"))
    for place in ("x", "x/x.h"):
        shown = run(*CHECK, place, cwd=deployed, code=1).stdout
        assert shown.startswith(f"REJECTED: {place} is not what the certificate is about\n  x.h: ")
        assert "it has '#define NRS_X_KD_OVER_T 0x1.f6ee02p+19F" in shown
        document = document_of(*CHECK, place, cwd=deployed)
        assert (document["verdict"], document["deployed"]) == ("rejected", place)
        assert len(document["differences"]) == 1


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("x.nrs.yaml", "none of the files that are compared"),
        ("x/nothing.h", "x/nothing.h: there is no such file"),
        ("nothing", "nothing: there is no such file or folder"),
    ],
)
def test_places_that_cannot_be_meant(firmware, place, said):
    assert said in run(*CHECK, place, cwd=firmware, code=2).stderr


def test_what_is_deployed_needs_its_own_spec(firmware):
    run("verify", "x/x.cert.json", "--deployed", "x", cwd=firmware, code=2)
    done = run("verify", "x/x.cert.json", COMMUTING, "--deployed", "x", cwd=firmware, code=1)
    assert "another spec" in done.stdout


def test_swapped_files_are_named_in_their_order(tmp_path):
    done = run("verify", "specs/a.nrs.yaml", "reports/a.cert.json", cwd=tmp_path, code=2)
    assert done.stderr == (
        "error[NRS004]: the arguments are swapped (the certificate comes first: "
        "nrs-design verify reports/a.cert.json specs/a.nrs.yaml)\n"
    )
