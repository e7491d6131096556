"""Design of compliant controllers for surgical co-worker robots, with proofs.

``import nrs_design as nrs`` offers `nrs.certify`, `nrs.check_lyapunov`, `nrs.load` and
`nrs.verify`; what they need is imported when they are first asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.api import Decision, Study, certify, check_lyapunov, load, verify
    from nrs_design.search.gradient_settings import Gradient

__version__ = "0.1.0"

__all__ = ["Decision", "Gradient", "Study", "certify", "check_lyapunov", "load", "verify"]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = "nrs_design.search.gradient_settings" if name == "Gradient" else "nrs_design.api"
    return getattr(import_module(home), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
