"""What the gate prints: for people, GitHub, code scanners and test reporters."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from nrs_design.gating.formats.github import format_github
from nrs_design.gating.formats.json_document import format_json
from nrs_design.gating.formats.junit import format_junit
from nrs_design.gating.formats.sarif import format_sarif
from nrs_design.gating.formats.text import format_markdown, format_text
from nrs_design.gating.obligations import GateOutcome

FORMATS: Mapping[str, Callable[[GateOutcome], str]] = MappingProxyType(
    {
        "text": format_text,
        "github": format_github,
        "sarif": format_sarif,
        "junit": format_junit,
        "json": format_json,
        "markdown": format_markdown,
    }
)
