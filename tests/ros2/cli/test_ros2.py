"""``nrs-design ros2`` as a user types it."""

import re
import shlex

import pytest

from nrs_design.ros2.law import read_law
from nrs_design.ros2.parameters import parse_nodes
from tests.ros2.support import EXAMPLE, changed
from tests.support import ROOT, document_of, run
from tests.tables import rows


@pytest.mark.parametrize(
    ("edit", "options", "message"),
    rows(__file__, "test_every_remedy_that_is_printed_works_when_pasted"),
)
def test_every_remedy_that_is_printed_works_when_pasted(tmp_path, edit, options, message):
    options = shlex.split(options)
    command = ("ros2", "check", changed(tmp_path, edit) if edit else EXAMPLE, "--budget", "1")
    done = run(*command, *options, cwd=tmp_path)
    said = done.stdout + done.stderr
    assert done.returncode in (2, 3)
    assert message in said
    remedies = {*re.findall(r"(--[a-z-]+ (?:'[^']+'|[0-9][0-9.]*))", said)}
    assert remedies
    for remedy in remedies:
        option, value = shlex.split(remedy)
        given = dict(zip(options[::2], options[1::2], strict=True)) | {option: value}
        again = run(*command, *(word for pair in given.items() for word in pair), cwd=tmp_path)
        assert again.returncode in (0, 1), (remedy, again.stderr)


@pytest.fixture
def spec(tmp_path):
    """Soft tissue with a force of one age, so that lost contact is modelled."""
    text = (ROOT / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml").read_text()
    file = tmp_path / "one-age.nrs.yaml"
    file.write_text(text.replace("delay: [0, 1]", "delay: 1"))
    return file


EXPORT = ("ros2", "export", "one-age.nrs.yaml", "--axis", "ry", "--lag", "5..20 ms", "--out", "out")


@pytest.mark.slow
def test_export(spec, tmp_path):
    done = run(*EXPORT, cwd=tmp_path, code=0)
    assert "PROVED, exported to out/soft-tissue-sampled.insertion.ros2.yaml" in done.stdout
    names = ["soft-tissue-sampled.insertion.ros2", "soft-tissue-sampled.withdrawal.ros2"]
    files = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert files == [f"{name}.{ending}" for name in names for ending in ("cert.json", "yaml")]
    before = {path: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    proof = "out/soft-tissue-sampled.insertion.ros2.cert.json"
    run("verify", proof, cwd=tmp_path, code=0)
    met = ("--rotational-stiffness", "41.51..44.24 N*m/rad", "--age", "1", "--lag", "5..20 ms")
    run("ros2", "check", "out/soft-tissue-sampled.insertion.ros2.yaml", *met, cwd=tmp_path, code=0)
    assert document_of(*EXPORT, cwd=tmp_path)["controllers"] == {
        "insertion": "proved",
        "withdrawal": "proved",
    }
    assert {path: path.read_bytes() for path in before} == before


def test_all_axes_of_a_file_are_one_parameter_file(tmp_path):
    """The controllers of z, and beside each the only one of the other axes."""
    axes = ROOT / "docs/examples/six-axes.nrs.yaml"
    done = run("ros2", "export", axes, "--lag", "27..33 ms", cwd=tmp_path, code=0)
    assert "PROVED, exported to reports/six-axes.insertion.ros2.yaml" in done.stdout
    written = (tmp_path / "reports/six-axes.insertion.ros2.yaml").read_text(encoding="utf-8")
    nodes = parse_nodes(written, tmp_path)
    law = read_law(next(node for node in nodes if node.name == "admittance_controller"))
    assert [axis.selected for axis in law.axes] == [True] * 6
    assert [float(axis.mass) for axis in law.axes] == pytest.approx([0.2, 0.2, 0.16] + [0.008] * 3)
    assert float(law.joint_damping) == pytest.approx(450)
    proofs = sorted((tmp_path / "reports").glob("*.insertion.*.ros2.cert.json"))
    assert len(proofs) == 6
    for proof in proofs:
        assert "PROVED" in run("verify", proof, cwd=tmp_path, code=0).stdout
    # What the file says is decided again, of every axis.
    checked = ("--stiffness", "700..1500 N/m", "--rotational-stiffness", "30..50 N*m/rad")
    again = ("ros2", "check", "reports/six-axes.insertion.ros2.yaml", *checked)
    done = run(*again, "--age", "1", "--lag", "27..33 ms", cwd=tmp_path, code=0)
    assert done.stdout.count("stable") == 6
