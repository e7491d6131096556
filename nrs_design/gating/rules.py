"""Catalogue of rules, with meaning and remedy of each finding.

`rules.toml` holds the texts. Ids are stable: they stand in lock files, annotations, baselines of
code scanners and in the ``rule`` of every error in `nrs_design.errors`. An id is never given a
second meaning; NRS111 and NRS112 were used before 1.0.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Rule:
    """One kind of finding."""

    id: str  # Such as ``NRS102``
    title: str  # What should be the case, in a few words
    explanation: str  # Meaning of the rule, and the method that decides
    remedy: str  # Advice for a broken rule

    @property
    def heading(self) -> str:
        """Its id and title."""
        return f"{self.id}: {self.title}"


@dataclass(frozen=True, slots=True)
class Word:
    """Status of an obligation, with meaning and remedy."""

    word: str
    explanation: str
    remedy: str

    @property
    def heading(self) -> str:
        """The word itself."""
        return self.word


_TABLE = tomllib.loads(Path(__file__).with_name("rules.toml").read_text(encoding="utf-8"))
RULES: Mapping[str, Rule] = MappingProxyType(
    {key: Rule(key, **texts) for key, texts in _TABLE["rules"].items()}
)
WORDS: Mapping[str, Word] = MappingProxyType(
    {word: Word(word, **texts) for word, texts in _TABLE["words"].items()}
)

SPEC = RULES["NRS001"]
MODE_STABLE = RULES["NRS101"]
SWITCHING_STABLE = RULES["NRS102"]
STIFFNESS_RANGE = RULES["NRS103"]
CERTIFICATE_HOLDS = RULES["NRS104"]
LOCKED = RULES["NRS105"]
GOAL = RULES["NRS106"]
NOT_DOUBTED = RULES["NRS107"]
CERTIFIED_GOAL = RULES["NRS108"]
SCENARIO_LIMIT = RULES["NRS109"]
NOT_WEAKER = RULES["NRS110"]
INTERNAL = RULES["NRS900"]
