"""Commands as a user types them: sessions in folders of their own, from tables beside this file.

A session has a `name`, `files` that are there at first, and `steps`; one of one step is that step.
It may come `after` another one, and begins in a copy of its folder. A step may `write`, `move`,
`copy`, `link`, `edit` (what is replaced, by what, ...) and `remove` files, and then `run` a line,
`in` a folder below. Words that begin with ``@`` are paths from the root of the project. Each
run has its exit `code`, 0 if none is said, and may say what stands on stdout (`says`), how that
`begins` or what all of it is (`prints`), what stands on stderr (`warns`), and what is in neither
(`never`). `json` are values by their path in the document of ``--json``, which is added, `holds`
words of files, and `left` all files that are there then, and files
that are the `same`. A step may change the entries of a `lock` by their paths.
"""

import atexit
import json
import shutil
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import pytest

from tests.support import replaced, run
from tests.tables import files_in, table, words_in, write_files


def sessions():
    return [
        pytest.param(
            session,
            id=f"{file.stem}-{session['name'].replace(' ', '-')}",
            marks=[pytest.mark.slow] if session.get("slow") else [],
        )
        for file in sorted(Path(__file__).parent.glob("*.yaml"))
        for session in table(file)
    ]


def listed(value):
    return value if isinstance(value, list) else [value]


def value_at(document, path):
    for part in path.split("."):
        document = document[int(part) if isinstance(document, list) else part]
    return document


def holds(value, wanted):
    """Compare a value of a document with what a table says of it."""
    match wanted:
        case {"about": number}:
            return value == pytest.approx(number, rel=1e-3)
        case {"above": low, "below": high}:
            return low < value < high
        case {"above": low}:
            return value > low
        case {"has": item}:
            return item in value
        case {"begins": text}:
            return value.startswith(text)
        case {"count": number}:
            return len(value) == number
        case {"keys": names}:
            return list(value) == names
        case {"each": names, "are": rows}:
            return [[item[name] for name in names] for item in value] == rows
        case {"lacks": text}:
            return text not in str(value)
        case {"words": texts}:
            return all(word in str(value) for word in texts)
    return value == wanted


def change_lock(changes, folder):
    """Set values of the entries of a lock file by their paths, or take them away."""
    document = json.loads((folder / "nrs.lock").read_text(encoding="utf-8"))
    for path, value in changes.items():
        *above, last = path.split(".")
        box = value_at(document["specs"], ".".join(above)) if above else document["specs"]
        if isinstance(box, list) and value is None:
            del box[int(last)]
        else:
            box[int(last) if isinstance(box, list) else last] = value
    (folder / "nrs.lock").write_text(json.dumps(document), encoding="utf-8")


def prepare(step, folder):
    write_files(step.get("write", {}), folder)
    for name, target in step.get("move", {}).items():
        (folder / target).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).rename(folder / target)
    for name, target in step.get("copy", {}).items():
        shutil.copy(folder / name, folder / target)
    for name, target in step.get("link", {}).items():
        (folder / name).symlink_to(folder / target)
    for name, edit in step.get("edit", {}).items():
        pairs = zip(edit[::2], edit[1::2], strict=True)
        text = replaced((folder / name).read_text(encoding="utf-8"), *pairs)
        (folder / name).write_text(text, encoding="utf-8")
    if "lock" in step:
        change_lock(step["lock"], folder)
    for name in step.get("remove", []):
        (folder / name).unlink()


def check(step, done):
    for key, text in (("says", done.stdout), ("warns", done.stderr)):
        said = f"{text}\n{' '.join(text.split())}"
        for words in listed(step.get(key, [])):
            assert words in said, said
    for words in listed(step.get("never", [])):
        assert words not in done.stdout + done.stderr
    assert done.stdout.startswith(step.get("begins", "")), done.stdout
    assert done.stdout == step.get("prints", done.stdout)
    document = json.loads(done.stdout) if "json" in step else None
    for path, wanted in step.get("json", {}).items():
        found = value_at(document, path)
        assert holds(found, wanted), (path, found)


@cache
def begun(name):
    """Return a folder in which a session was taken that others begin with."""
    (session,) = (param.values[0] for param in sessions() if param.values[0]["name"] == name)
    folder = Path(mkdtemp(prefix="session-"))
    atexit.register(shutil.rmtree, folder)
    take(session, folder)
    return folder


@pytest.mark.parametrize("session", sessions())
def test_session(session, tmp_path):
    if "after" in session:
        shutil.copytree(begun(session["after"]), tmp_path, dirs_exist_ok=True)
    take(session, tmp_path)


def take(session, tmp_path):
    write_files(session.get("files", {}), tmp_path)
    for step in session.get("steps", [session]):
        prepare(step, tmp_path)
        if "run" in step:
            words = [*words_in(step["run"]), *(["--json"] if "json" in step else [])]
            folder = tmp_path / step.get("in", ".")
            check(step, run(*words, cwd=folder, code=step.get("code", 0)))
        for name, words in step.get("holds", {}).items():
            text = " ".join((tmp_path / name).read_text(encoding="utf-8").replace("*", " ").split())
            assert all(word in text for word in listed(words)), (name, text)
        contents = {(tmp_path / name).read_bytes() for name in step.get("same", [])}
        assert len(contents) <= 1
        if "left" in step:
            assert files_in(tmp_path) == step["left"]
