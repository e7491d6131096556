"""Design of compliant controllers for surgical co-worker robots, with proofs.

``import nrs_design as nrs`` offers `nrs.load`, `nrs.certify`, `nrs.identify`,
`nrs.check_lyapunov` and `nrs.verify`; what they need is imported when they are first asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.api import (
        Decision,
        Gradient,
        Optimum,
        Study,
        certify,
        check_lyapunov,
        identify,
        load,
        verify,
    )

__version__ = "0.1.0"

__all__ = [
    "Decision",
    "Gradient",
    "Optimum",
    "Study",
    "certify",
    "check_lyapunov",
    "identify",
    "load",
    "verify",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module("nrs_design.api"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
