"""Missed deadlines of a sampled design as a user types them: prove, export, simulate."""

from tests.support import SOFT_TISSUE, run


def test_from_a_spec_to_a_header(tmp_path):
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    rule = "sampling: {period: 2 ms, delay: 0, misses: {consecutive: 1, command: hold}}"
    path = tmp_path / "missing.nrs.yaml"
    path.write_text(f"{text}\n{rule}\ncontact: kept\n", encoding="utf-8")
    proof = tmp_path / "missing.cert.json"
    said = " ".join(
        run("certify-switching", path, "--out", proof, cwd=tmp_path, code=0).stdout.split()
    )
    assert "PROVED" in said
    assert "with any mode in force that the rule for missed deadlines allows" in said
    assert "at most 1 period in a row miss their deadline" in said
    given = ("--certificate", proof, "--out", tmp_path)
    run("export", path, "--format", "c", *given, cwd=tmp_path, code=0)
    run("export", path, "--format", "monitor", *given, cwd=tmp_path, code=0)
    (header,) = (path for path in tmp_path.glob("*.h") if "monitor" not in path.name)
    words = " ".join(header.read_text(encoding="utf-8").replace("*", " ").split())
    assert "may be missed: no step is made then, and the command before is held" in words
    watched = next(tmp_path.glob("*monitor.h")).read_text(encoding="utf-8")
    assert "Not monitored: How many deadlines are missed" in watched
    assert "deadlines missed:" in run("simulate", path, cwd=tmp_path).stdout
