"""``nrs-design ros2`` as a user types it."""

import re
import shlex

import pytest

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
