"""`nrs-design check`, as a user types it."""

from __future__ import annotations

from pathlib import Path

from tests.support import SOFT_TISSUE, document_of, run, typed


def test_check_prints_values_as_written_and_in_si(tmp_path: Path) -> None:
    result = typed("check", SOFT_TISSUE, "-v", cwd=tmp_path, code=0)
    line = next(line for line in result.stdout.splitlines() if "limits.velocity" in line)
    assert line.split()[1:] == ["8", "deg/s", "0.139626", "rad/s"]


def test_check_goes_on_after_a_broken_spec(tmp_path: Path) -> None:
    broken = tmp_path / "broken.nrs.yaml"
    broken.write_text("kind: switched-system\nname: x\ntime: continuous\nmodes: []\n")
    result = run("check", "-q", broken, SOFT_TISSUE, cwd=tmp_path, code=2)
    assert "broken.nrs.yaml:" in result.stderr
    assert "NRS001" in result.stderr


def test_an_environment_that_no_controller_touches_is_a_warning(tmp_path: Path) -> None:
    hand = "environments:\n  hand: {model: elastic, stiffness: 60 N*m/rad}\n"
    path = tmp_path / "hand.nrs.yaml"
    path.write_text(SOFT_TISSUE.read_text().replace("environments:\n", hand))
    result = run("check", path.name, cwd=tmp_path, code=0)
    line = path.read_text().split("\n").index(hand.split("\n")[1]) + 1
    assert f"warning: hand.nrs.yaml:{line}:3: environment hand is touched by no" in result.stderr
    (spec,) = document_of("check", path.name, cwd=tmp_path)["specs"]
    assert len(spec["warnings"]) == 1
    assert "warning" not in run("check", SOFT_TISSUE, cwd=tmp_path).stderr


def test_a_controller_designed_for_what_it_does_not_touch_is_refused(tmp_path: Path) -> None:
    """Designed for 90 N m/rad and touching 43: nothing would be proved where it is to work."""
    text = SOFT_TISSUE.read_text().replace(
        "environments:\n", "environments:\n  hand: {model: elastic, stiffness: 90 N*m/rad}\n"
    )
    text = text.replace("    environment: soft\n", "    environment: hand\n    contacts: [soft]\n")
    path = tmp_path / "hand.nrs.yaml"
    path.write_text(text)
    result = run("check", path.name, cwd=tmp_path, code=2)
    line = text.split("\n").index("    contacts: [soft]") + 1
    assert f" --> hand.nrs.yaml:{line}:15\n" in result.stderr
    assert "add hand to contacts" in result.stderr
