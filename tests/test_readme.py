"""What the README shows is what the program prints."""

import re
import shutil
from pathlib import Path

import pytest

from tests.support import ROOT, run

README = (ROOT / "README.md").read_text()
SESSION = re.compile(r"^\$ nrs-design (.*)\n((?:(?!\$ |```).*\n)*)", re.MULTILINE)
SESSIONS = SESSION.findall(README)


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("checkout")
    for name in ("specs", "docs", "reports"):
        pages = shutil.ignore_patterns("*.html", "*.png")
        shutil.copytree(ROOT / name, folder / name, ignore=pages)
    return folder


NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def assert_same(printed: str, shown: str) -> None:
    """Compare words exactly, and numbers to 2 %: last digits differ between processors."""
    texts = [re.sub(r"\b[0-9a-f]{12}\b", "id", text) for text in (printed, shown)]
    words, wanted = ([" ".join(NUMBER.sub("#", text).split())] for text in texts)
    assert words == wanted, printed
    numbers, expected = ([float(number) for number in NUMBER.findall(text)] for text in texts)
    assert numbers == pytest.approx(expected, rel=0.02, abs=1e-3), printed


def test_the_readme_shows_sessions() -> None:
    assert len(SESSIONS) >= 2


def test_it_is_short() -> None:
    assert len(README.split()) <= 800


@pytest.mark.parametrize(("command", "shown"), SESSIONS)
def test_output(command: str, shown: str, checkout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    result = run(*command.split(), cwd=checkout)
    assert_same(result.stdout, shown)


def test_the_two_commands_of_the_readme_are_those_of_ci() -> None:
    script = (ROOT / ".ci/run").read_text()
    commands = (
        "python -m pip install . && nrs-design gate specs/",
        "python -m pip install nox && nox",
    )
    for command in commands:
        assert f"\n{command}\n" in README
        assert f"\n{command}\n" in script
