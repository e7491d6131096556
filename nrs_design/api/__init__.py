"""The library at the door: what ``import nrs_design as nrs`` offers."""

from nrs_design.api.decision import Decision
from nrs_design.api.matrices import certify, check_lyapunov
from nrs_design.api.measured import identify
from nrs_design.api.optimum import Optimum
from nrs_design.api.study import Study, load
from nrs_design.api.verification import verify
from nrs_design.search.gradient_settings import Gradient

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
