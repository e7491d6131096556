"""What the gate prints: for people, GitHub, code scanners and test reporters."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from nrs_design.gating.formats.github import to_github
from nrs_design.gating.formats.json_document import to_json
from nrs_design.gating.formats.junit import to_junit
from nrs_design.gating.formats.sarif import to_sarif
from nrs_design.gating.formats.text import to_markdown, to_text
from nrs_design.gating.obligations import GateOutcome

FORMATS: Mapping[str, Callable[[GateOutcome], str]] = MappingProxyType(
    {
        "text": to_text,
        "github": to_github,
        "sarif": to_sarif,
        "junit": to_junit,
        "json": to_json,
        "markdown": to_markdown,
    }
)
