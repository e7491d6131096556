"""The library at the door: what ``import nrs_design as nrs`` offers, imported when it is used."""

from typing import TYPE_CHECKING

from nrs_design.late import late_names

if TYPE_CHECKING:
    from nrs_design.api.audit import Audit as Audit
    from nrs_design.api.audit import AuditCheck as AuditCheck
    from nrs_design.api.decision import Decision as Decision
    from nrs_design.api.exported import Exported as Exported
    from nrs_design.api.identified import FittedRange as FittedRange
    from nrs_design.api.identified import Identification as Identification
    from nrs_design.api.identified import identify as identify
    from nrs_design.api.lyapunov import Counterexample as Counterexample
    from nrs_design.api.lyapunov import LyapunovCheck as LyapunovCheck
    from nrs_design.api.matrices import certify as certify
    from nrs_design.api.matrices import check_lyapunov as check_lyapunov
    from nrs_design.api.optimum import Optimum as Optimum
    from nrs_design.api.recheck import Recheck as Recheck
    from nrs_design.api.recheck import verify as verify
    from nrs_design.api.simulation import ScenarioRun as ScenarioRun
    from nrs_design.api.simulation import Simulation as Simulation
    from nrs_design.api.study import Study as Study
    from nrs_design.api.study import load as load
    from nrs_design.api.worst import WorstFound as WorstFound

__getattr__ = late_names(
    __name__,
    {
        "audit": "Audit AuditCheck",
        "decision": "Decision",
        "exported": "Exported",
        "identified": "FittedRange Identification identify",
        "lyapunov": "Counterexample LyapunovCheck",
        "matrices": "certify check_lyapunov",
        "optimum": "Optimum",
        "recheck": "Recheck verify",
        "simulation": "ScenarioRun Simulation",
        "study": "Study load",
        "worst": "WorstFound",
    },
)
