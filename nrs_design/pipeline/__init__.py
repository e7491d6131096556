"""The one place that knows every stage: spec, plant, design, switched system, certificate.

A design and its proof are at the door; margins, subsets, scenarios, robots and releases are
imported from their modules, so that a bare proof loads none of them.
"""

from nrs_design.pipeline.certification import (
    Overrides,
    Result,
    assemble_spec,
    find_relief,
    limits_of,
    run_certification,
    run_comparison,
    run_recorded,
    run_verification,
)
from nrs_design.pipeline.design import (
    Designed,
    Progress,
    placed,
    run_analysis,
    run_design,
    silent,
    wrong_kind,
)

__all__ = [
    "Designed",
    "Overrides",
    "Progress",
    "Result",
    "assemble_spec",
    "find_relief",
    "limits_of",
    "placed",
    "run_analysis",
    "run_certification",
    "run_comparison",
    "run_design",
    "run_recorded",
    "run_verification",
    "silent",
    "wrong_kind",
]
