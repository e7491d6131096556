"""The one place that knows every stage: spec, plant, design, switched system, certificate.

A design and its proof are at the door; margins, subsets, scenarios, robots and releases are
imported from their modules, so that a bare proof loads none of them.
"""

from nrs_design.pipeline.certification import (
    Overrides,
    Result,
    assemble_spec,
    find_relief,
    read_valid_certificate,
    recorded_certification,
    run_certification,
    run_comparison,
    run_recorded,
    run_verification,
    search_limits,
)
from nrs_design.pipeline.design import (
    Designed,
    interaction_of,
    placed,
    run_analysis,
    run_design,
    run_interaction,
    wrong_kind,
)

__all__ = [
    "Designed",
    "Overrides",
    "Result",
    "assemble_spec",
    "find_relief",
    "interaction_of",
    "placed",
    "read_valid_certificate",
    "recorded_certification",
    "run_analysis",
    "run_certification",
    "run_comparison",
    "run_design",
    "run_interaction",
    "run_recorded",
    "run_verification",
    "search_limits",
    "wrong_kind",
]
