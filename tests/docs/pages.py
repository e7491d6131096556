"""What pages show to be typed: sessions, commands and Python."""

import re

from tests.support import ROOT

DOCS = ROOT / "docs"
CONSOLE = re.compile(r"^```console\n(.*?)^```", re.MULTILINE | re.DOTALL)
PYTHON = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
STEP = re.compile(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", re.MULTILINE)
# A command on a line of its own, in a session or not; a backslash continues it.
COMMAND = re.compile(r"^(?:\$|    )? ?nrs-design ((?:.*\\\n)*.*)$", re.MULTILINE)


def pages() -> list[str]:
    """Every page of the documentation and the README, as paths below the root."""
    found = [path.relative_to(ROOT).as_posix() for path in sorted(DOCS.rglob("*.md"))]
    return ["README.md", *found]


def text_of(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def kind_pages() -> dict[str, str]:
    """The page of each kind of evidence, by the table of `docs/certificates/README.md`."""
    rows = re.findall(
        r"^\| `([\w-]+)` \| .* \| \[.*\]\(([\w-]+\.md)",
        text_of("docs/certificates/README.md"),
        re.MULTILINE,
    )
    return {kind: f"docs/certificates/{page}" for kind, page in rows}


def session_of(page: str) -> list[tuple[str, str]]:
    """Commands behind ``$``, each with what it prints, in the order of the page."""
    return [step for block in CONSOLE.findall(text_of(page)) for step in STEP.findall(block)]


def python_of(page: str) -> list[str]:
    return PYTHON.findall(text_of(page))


def commands_of(page: str) -> list[str]:
    return [line.replace("\\\n", " ") for line in COMMAND.findall(text_of(page))]
