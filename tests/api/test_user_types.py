"""A file of a user's own passes ``mypy --strict``, and nothing of the library is Any in it."""

import re
import subprocess
import sys

from tests.support import ROOT
from tests.tables import entry

WAY = entry(__file__, "WAY")

# An expression, and what it is; `Any` of JSON documents stands in `to_dict` alone.
REVEALED = entry(__file__, "REVEALED")


def mypy(folder, text):
    (folder / "user.py").write_text(text, encoding="utf-8")
    cache = ROOT / ".mypy_cache" / "user"
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={cache}",
         "--follow-imports=silent", "user.py"],
        cwd=folder,
        env={"MYPYPATH": str(ROOT), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )  # fmt: skip
    return done.stdout


def test_the_whole_way_is_typed(tmp_path):
    lines = [f"reveal_type({expression})" for expression in REVEALED]
    said = mypy(tmp_path, "\n".join([WAY, *lines, ""]))
    assert re.findall(r": error: .*", said) == []
    revealed = re.findall(r'Revealed type is "(.*)"', said)
    plain = [text.replace("builtins.", "") for text in revealed]
    assert dict(zip(REVEALED, plain, strict=True)) == REVEALED


def test_a_slip_is_told_before_it_runs(tmp_path):
    said = mypy(
        tmp_path,
        "import nrs_design as nrs\n"
        "nrs.laod('x')\n"
        "nrs.load('x').certify().verdikt\n"
        "nrs.identify(3)\n"
        "nrs.load('x').simulate()['a'].time.shap\n",
    )
    assert [int(line) for line in re.findall(r"user\.py:(\d+): error", said)] == [2, 3, 4, 5]
