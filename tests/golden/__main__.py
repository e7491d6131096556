"""Write the answers of all commands anew, or those of the names that are given."""

import json
import sys
import tempfile
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from tests.golden.answers import ANSWERS, answer, rows
from tests.golden.combinations import rewrite


def main(names: list[str]) -> None:
    for name, commands in groupby(rows(), itemgetter(0)):
        if names and name not in names:
            continue
        found = {}
        for _, command in commands:
            with tempfile.TemporaryDirectory() as folder:
                found[command] = answer(name, command, Path(folder))
        text = json.dumps(found, indent=1, ensure_ascii=False)
        (ANSWERS / f"{name}.json").write_text(f"{text}\n", encoding="utf-8")
    if not names or "combinations" in names:
        rewrite()


if __name__ == "__main__":
    main(sys.argv[1:])
