"""The hash of what a document says."""

from __future__ import annotations

import hashlib
import json


def hash_meaning(said: object) -> str:
    """Return the SHA-256 of what a document says, as `to_data` or JSON has it, in hexadecimal.

    Two documents share it exactly if they have the same keys in the same order and the same texts:
    comments, line ends, quotes and layout do not count. A spec is read from these texts and from
    nothing else. Order counts because modes are numbered in the order of the controllers.
    """
    canonical = json.dumps(said, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(canonical.encode()).hexdigest()
