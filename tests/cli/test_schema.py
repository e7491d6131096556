"""`nrs-design schema`, as a user types it."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from tests.support import run, typed


@pytest.mark.slow
def test_schema_is_draft_07(tmp_path: Path) -> None:
    typed("schema", "--out", "nrs.schema.json", cwd=tmp_path, code=0)
    schema = json.loads((tmp_path / "nrs.schema.json").read_text())
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    jsonschema.Draft7Validator.check_schema(schema)


def test_schema_of_exports(tmp_path: Path) -> None:
    for of in ("spec", "export", "export"):
        run("schema", "--of", of, "--out", "x.json", cwd=tmp_path, code=0)
    schema = json.loads((tmp_path / "x.json").read_text())
    assert (schema["title"], schema["additionalProperties"]) == ("nrs-design export", False)
    assert schema["properties"]["schema"]["const"] == "nrs-design/export/1"
