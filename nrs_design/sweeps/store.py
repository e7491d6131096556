"""Where answers of points are kept: a file each, whole or not at all, named by what it answers.

The name is the SHA-256 of what the spec of the point means, of the command with its options, and of
the version of this program. A file that is not as it was written is as good as none: the point is
computed again. What it claims is no evidence; see `nrs_design.sweeps.claims`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nrs_design.files import open_regular, read_json_text, unique_keys
from nrs_design.output import write_output
from nrs_design.printable import json_text
from nrs_design.spec.document import Data, hash_meaning

SCHEMA = "nrs-design/point/1"
# Larger than any answer, in bytes.
MAX_BYTES = 64 * 2**20


@dataclass(frozen=True, slots=True)
class CachedAnswer:
    """The answer of a command about one point."""

    code: int  # With which the command ends
    result: Mapping[str, Any]  # Its JSON document, without times and places of files

    def id(self, key: str) -> str:
        """Return the SHA-256 of what is written of it under a name, in hexadecimal."""
        return hash_meaning(self.said(key))

    def text(self, key: str) -> str:
        """Return what is written of it under a name."""
        return json_text({**self.said(key), "id": self.id(key)}) + "\n"

    def said(self, key: str) -> dict[str, Any]:
        """Return what is written of it under a name, but for its id."""
        return {"schema": SCHEMA, "key": key, "code": self.code, "result": dict(self.result)}


@dataclass(frozen=True, slots=True)
class Store:
    """A folder of answers."""

    folder: Path

    def entry(self, key: str) -> Path:
        """Return the file of an answer."""
        return self.folder / key[:2] / f"{key}.json"

    def certificate(self, key: str) -> Path:
        """Return the file of the certificate beside it."""
        return self.folder / key[:2] / f"{key}.cert.json"

    def read(self, key: str) -> CachedAnswer | None:
        """Return what is kept; None if nothing is, or it is not as it was written."""
        try:
            with open_regular(self.entry(key)) as file:
                text = read_json_text(file.read(MAX_BYTES + 1))
            document = json.loads(text, object_pairs_hook=unique_keys)
            kept = CachedAnswer(int(document["code"]), dict(document["result"]))
            is_whole = document == {**kept.said(key), "id": kept.id(key)}
            return kept if is_whole else None
        except (OSError, ValueError, LookupError, TypeError, RecursionError):
            return None

    def write(self, key: str, kept: CachedAnswer) -> None:
        """Keep an answer, in the place of what is there."""
        write_output(self.entry(key), kept.text(key))

    def drop_certificate(self, key: str) -> None:
        """Forget what shows the claims of an answer; another run may be reading the answer."""
        # Where that is refused, so is writing another one, with a message of its own.
        with suppress(OSError):
            self.certificate(key).unlink()


def key_of(meaning: Data, asked: Data, version: str) -> str:
    """Return the name of an answer, in hexadecimal."""
    return hash_meaning({"spec": meaning, "asked": asked, "version": version})
