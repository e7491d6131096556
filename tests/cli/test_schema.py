"""`nrs-design schema`, as a user types it."""

from __future__ import annotations

import json
from pathlib import Path

from tests.support import run


def test_schema_of_exports(tmp_path: Path) -> None:
    for of in ("spec", "export", "export"):
        run("schema", "--of", of, "--out", "x.json", cwd=tmp_path, code=0)
    schema = json.loads((tmp_path / "x.json").read_text())
    assert (schema["title"], schema["additionalProperties"]) == ("nrs-design export", False)
    assert schema["properties"]["schema"]["const"] == "nrs-design/export/1"
