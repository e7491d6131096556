"""`nrs-design map`, as a user types it."""

import csv
import json

from tests.support import ROOT, document_of, run

SAMPLED = ROOT / "specs" / "neuroboscope" / "soft-tissue-sampled.nrs.yaml"
STIFFNESS = "environments.soft.stiffness=300..1100/4 N/m"


def test_a_map_for_people_and_files(tmp_path):
    files = "--figure", "m.png", "--csv", "m.csv", "--certificates", "certificates"
    asked = "--over", STIFFNESS, "--over", "sampling.delay=0..1"
    shown = run("map", SAMPLED, *asked, *files, cwd=tmp_path, code=3).stdout
    assert "8 tiles:" in shown
    assert "# proved, o refuted in kept contact" in shown
    rows = (tmp_path / "m.csv").read_text().splitlines()
    assert rows[0] == "verdict,certificate,refuted_in,environments.soft.stiffness,sampling.delay"
    assert len(rows) == 9
    assert (tmp_path / "m.png").stat().st_size > 1000
    # Each certificate shows again what the table says of its tiles: growth in kept contact leaves
    # open what losing it does.
    said = {identity: verdict for verdict, identity, *_ in csv.reader(rows[1:]) if identity}
    assert set(said.values()) == {"proved", "inconclusive"}
    codes = {"proved": 0, "inconclusive": 3}
    for identity, verdict in said.items():
        first = tmp_path / "certificates" / f"{identity[:16]}.cert.json"
        spec = first.with_name(first.name.replace(".cert.json", ".nrs.yaml"))
        run("verify", first, spec, cwd=tmp_path, code=codes[verdict])
    # By itself, the spec has the gains that are proved.
    gains = json.loads(first.read_text())["gains"]["withdrawal"]["Bt"]
    assert gains.startswith("1.0399999")
    designed = document_of("optimize", spec, cwd=tmp_path)["controllers"][1]
    assert designed["Bt"] == float(gains)


def test_a_map_for_programs(tmp_path):
    document = document_of("map", SAMPLED, "--over", STIFFNESS, cwd=tmp_path)
    assert document["tiles"][0]["verdict"] == "proved"
    assert document["fields"][0]["cut"] == "interval"
    proved = document["tiles"][0]["certificate"]
    assert document["certificates"][proved]["box"][0][0] == 0


def test_bad_requests(tmp_path):
    for said, words in (
        ("environments.soft.stiffness=5..1/4 N/m", "reversed"),
        ("environments.hard.stiffness=1..5/4 N/m", "there is no field"),
        ("environments.soft.stiffness=1..1000000000 N/m", "more than"),
        (f"environments.soft.stiffness=1..5/{'9' * 30} N/m", "more values than"),
        ("environments.soft.stiffness", "sets nothing"),
    ):
        refused = run("map", SAMPLED, "--over", said, cwd=tmp_path, code=2)
        assert words in refused.stderr
    assert not list(tmp_path.iterdir())


def test_a_field_without_effect_is_named(tmp_path):
    """All tiles of a stiffness that nobody touches are proved: that says nothing about it."""
    ghost = "  ghost: {model: elastic, stiffness: 100 N*m/rad}\n"
    text = (ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml").read_text()
    path = tmp_path / "ghost.nrs.yaml"
    path.write_text(text.replace("environments:\n", "environments:\n" + ghost))
    over = "--over", "environments.ghost.stiffness=100,1000 N*m/rad"
    done = run("map", path, *over, cwd=tmp_path)
    warned = "warning: environments.ghost.stiffness has no part in what is decided"
    assert warned in done.stderr.replace("\n ", "")
    assert "takes up to 12 things for granted" in done.stdout
    document = document_of("map", path, *over, cwd=tmp_path)
    assert document["without_effect"] == ["environments.ghost.stiffness"]
    assert len(document["certificates"][0]["assumptions"]) == 12


def test_specs_of_certificates_find_the_files_that_they_name(tmp_path):
    asked = "--over", STIFFNESS, "--certificates", "elsewhere"
    spec = ROOT / "specs/neuroboscope/soft-tissue-axes.nrs.yaml"
    assert "names files beside itself" in run("map", spec, *asked, cwd=tmp_path, code=2).stderr
    assert not list(tmp_path.iterdir())


def test_a_spec_that_was_changed_is_not_replaced(tmp_path):
    over = "--over", "environments.soft.stiffness=500,600 N/m"
    command = "map", ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml", *over
    for _ in range(2):
        run(*command, "--certificates", "folder", cwd=tmp_path)
    (spec,) = (tmp_path / "folder").glob("*.nrs.yaml")
    changed = spec.read_text() + "# mine\n"
    spec.write_text(changed)
    refused = run(*command, "--certificates", "folder", cwd=tmp_path, code=2)
    assert "is not overwritten" in refused.stderr.replace("\n ", "")
    assert spec.read_text() == changed
