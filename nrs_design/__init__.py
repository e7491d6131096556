"""Design of compliant controllers for surgical co-worker robots, with proofs.

``import nrs_design as nrs`` offers `nrs.load`, `nrs.certify`, `nrs.identify`,
`nrs.check_lyapunov` and `nrs.verify`; what they need is imported when they are first asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.api import (
        Audit,
        AuditCheck,
        Counterexample,
        Decision,
        Exported,
        FittedRange,
        Identification,
        LyapunovCheck,
        Optimum,
        Recheck,
        ScenarioRun,
        Simulation,
        Study,
        WorstFound,
        certify,
        check_lyapunov,
        identify,
        load,
        verify,
    )

__version__ = "1.0.0"

__all__ = [
    "Audit",
    "AuditCheck",
    "Counterexample",
    "Decision",
    "Exported",
    "FittedRange",
    "Identification",
    "LyapunovCheck",
    "Optimum",
    "Recheck",
    "ScenarioRun",
    "Simulation",
    "Study",
    "WorstFound",
    "certify",
    "check_lyapunov",
    "identify",
    "load",
    "verify",
]

# A type checker knows the names above, and is to tell of any other.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module("nrs_design.api"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
