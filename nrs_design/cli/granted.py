"""What stands behind a proof that is printed: how much it takes for granted, or all of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.cli.printing import detail, say, wants_details
from nrs_design.proof.text import counted

if TYPE_CHECKING:
    from nrs_design.pipeline.certification import Result


# The option -v prints as many names of modes; --json prints all names.
MODE_NAMES = 10


def print_granted(result: Result) -> None:
    """Print what is taken for granted: all of it, or how much and what is not modelled."""
    from nrs_design.certificates.catalogue import sentences

    certification = result.certification
    granted, names = certification.granted, [mode.name for mode in certification.system.modes]
    detail("  taken for granted (nrs-design report says how to test each):")
    for text in sentences(granted):
        detail(f"    - {text}")
    detail(f"  common quadratic function: {certification.common_quadratic}")
    remainder = f" and {len(names) - MODE_NAMES} more" if len(names) > MODE_NAMES else ""
    detail(f"  {counted(len(names), 'mode')}: {', '.join(names[:MODE_NAMES])}{remainder}")
    if granted and not wants_details():
        without = "; ".join(result.omits)
        besides = f"; not modelled: {without}" if without else ""
        say(f"  takes {counted(len(granted), 'thing')} for granted (-v){besides}")
