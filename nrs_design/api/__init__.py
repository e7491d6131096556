"""The library at the door: what ``import nrs_design as nrs`` offers."""

from nrs_design.api.audit import Audit, AuditCheck
from nrs_design.api.decision import Decision
from nrs_design.api.exported import Exported
from nrs_design.api.identified import FittedRange, Identification, identify
from nrs_design.api.lyapunov import Counterexample, LyapunovCheck
from nrs_design.api.matrices import certify, check_lyapunov
from nrs_design.api.optimum import Optimum
from nrs_design.api.recheck import Recheck, verify
from nrs_design.api.simulation import ScenarioRun, Simulation
from nrs_design.api.study import Study, load
from nrs_design.api.worst import WorstFound
from nrs_design.search.gradient_settings import Gradient

__all__ = [
    "Audit",
    "AuditCheck",
    "Counterexample",
    "Decision",
    "Exported",
    "FittedRange",
    "Gradient",
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
