"""Certificates with small errors in what is decided: kernel, script and page say the same of them.

Who does not know a kind or a shape says so, which agrees with everything.
"""

import contextlib
import copy
import json
import subprocess
import sys
from collections import defaultdict
from fractions import Fraction
from importlib.resources import files
from io import StringIO
from random import Random

import pytest

from nrs_design.certificates.certificate import canonical, content_id, to_document
from nrs_design.certificates.prove import held_system, prove, read_certificate
from tests.certificates.attacks import SHIPPED, found
from tests.proof.systems import SYSTEMS
from tests.support import ROOT, ends_soon, program_named

DECIDED = ("time", "states", "modes", "contact", "roundings", "clock", "switching", "statements")
# What says nothing, or only of how forms are scaled or values are distributed.
TOLD = ("denominator_log2", "fixed_parameters")
DEAR = ("growing-sequence, steps", "growing-sequence, left", "growing-sequence, two ways")
NODE = """
for (const text of require("fs").readFileSync(0, "utf8").trim().split("\\n")) {
  let all = [false];
  try {
    const { results, agrees } = check(text), told = results.map(([holds]) => holds);
    all = told.includes(false) ? [false] : told.includes(null) ? [null] : [agrees];
  } catch {}
  console.log(all[0]);
}
"""


def places(value, path=()):
    """Yield every place in a document: the keys that lead there."""
    keys = (
        value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    )
    for key in [key for key in keys if key not in TOLD]:
        yield (*path, key)
        yield from places(value[key], (*path, key))


def mutated(document, random):
    """Return what was done, and a document with a value changed, dropped, doubled or swapped."""
    kinds = defaultdict(list)  # So that long lists of numbers are not all that changes
    for path in places({key: document[key] for key in DECIDED if key in document}):
        kinds[tuple("#" if isinstance(key, int) else key for key in path)].append(path)
    *path, key = random.choice(kinds[random.choice(sorted(kinds))])
    box = document = copy.deepcopy(document)
    for step in path:
        box = box[step]
    how = random.choice(
        ("change", "drop", "double", "swap") if isinstance(key, int) else ("change", "drop")
    )
    if how == "change":
        box[key] = changed(box[key], random)
    elif how == "drop":
        del box[key]
    elif how == "double":
        box.insert(key, copy.deepcopy(box[key]))
    else:
        other = random.randrange(len(box))
        box[key], box[other] = box[other], box[key]
    return (how, *path, key), document


def changed(value, random):
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return random.choice((value + 1, -value, 0, 2 * value))
    if not isinstance(value, str):
        return type(value)()
    with contextlib.suppress(ValueError):
        number = Fraction(value)
        return str(random.choice((number * 2, number / 2, number + 1, -number)))
    return random.choice((f"{value}'", "modes", "0"))


def by_the_kernel(document):
    """Sign a document, its sentences and its verdict made anew, and tell whether it holds."""
    try:
        system = held_system(document)
        document |= to_document(read_certificate(document, system))
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        pass
    document["id"] = content_id(document)
    return prove(document).fault is None


def by_the_script(code, path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["check_elsewhere.py", str(path)])
    monkeypatch.setattr(sys, "tracebacklimit", 1000, raising=False)
    try:
        with contextlib.redirect_stdout(StringIO()):
            exec(code, {"__name__": "__main__"})
    except SystemExit as done:
        return {0: True, 3: None}.get(int(done.code), False)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        return False
    raise AssertionError("it did not say how it ended")


def by_the_page(documents):
    script = files("nrs_design.reporting").joinpath("templates/check.js").read_text("utf-8")
    texts = "\n".join(map(canonical, documents))
    command = [program_named("node"), "-e", script + NODE]
    done = subprocess.run(command, input=texts, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.parametrize(
    ("each", "left_out"),
    [
        pytest.param(3, DEAR, marks=pytest.mark.slow),
        pytest.param(80, (), marks=pytest.mark.nightly),
    ],
)
def test_three_checkers_agree(tmp_path, monkeypatch, each, left_out):
    random, path = Random(f"{each} of each"), tmp_path / "c.json"
    whole = {name: found(name) for name in SYSTEMS if name not in left_out}
    small = (path for path in SHIPPED if path.stat().st_size < 20_000)
    whole |= {path.name: json.loads(path.read_text()) for path in small}
    changes = [((name,), document) for name, document in whole.items()]
    for name, document in whole.items():
        changes += [
            ((name, *what), other)
            for _ in range(each)
            for what, other in [mutated(document, random)]
        ]
    script = ROOT / "docs" / "certificates" / "check_elsewhere.py"
    code = compile(script.read_text(), str(script), "exec")
    said = []
    for what, document in changes:
        holds = by_the_kernel(document)
        path.write_text(json.dumps(document))
        said.append((what, holds, by_the_script(code, path, monkeypatch)))
    pages = by_the_page([document for _, document in changes])
    assert sum(holds for _, holds, _ in said) > len(whole)
    apart = [
        (what, holds, script, page)
        for (what, holds, script), page in zip(said, pages, strict=True)
        if {script, page} - {None} - {holds}
    ]
    assert apart == []


def test_the_page_knows_missed_deadlines():
    """As it knows turns; where all may be missed, nothing holds that does so for one in two."""
    document = found("periodic-quadratic, missed")
    forged = copy.deepcopy(document)
    forged["clock"]["ahead"][1][1] = 1
    assert by_the_page([document, forged]) == [True, False]
    assert [by_the_kernel(document), by_the_kernel(forged)] == [True, False]


def test_what_is_not_known_is_said_before_anything_is_multiplied(tmp_path, monkeypatch):
    """A stay of an hour by power series with fractions, and many that are left in time."""
    document = found("mode-quadratic, left in time")
    document["switching"]["stays"][1][1]["shortest"] = "3600"
    script = ROOT / "docs" / "certificates" / "check_elsewhere.py"
    (tmp_path / "c.json").write_text(json.dumps({**document, "id": content_id(document)}))
    with ends_soon():
        code = compile(script.read_text(), str(script), "exec")
        assert by_the_script(code, tmp_path / "c.json", monkeypatch) is None
