"""A file of a user's own passes ``mypy --strict``, and nothing of the library is Any in it."""

import re
import subprocess
import sys

from tests.support import ROOT

WAY = """
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

import nrs_design as nrs

study: nrs.Study = nrs.load("soft-tissue.nrs.yaml")

found: nrs.Identification = nrs.identify(["one.csv", "two.csv"], law="elastic")
stiffness: nrs.FittedRange = found.ranges["k"]
width: float = stiffness.high - stiffness.low

optimum: nrs.Optimum = study.optimize()
damping: float = optimum.gains["insertion"]["Bt"]
peak: float = optimum.margins["withdrawal"]["max_sensitivity_peak"]

decision: nrs.Decision = study.certify(budget=30)
P: NDArray[np.float64] | None = decision.P
figure: Figure = decision.plot("run", width="ieee")

simulation: nrs.Simulation = study.simulate("shaken")
run: nrs.ScenarioRun = simulation["shaken"]
torque: NDArray[np.float64] = run["torque"]
unit: str = run.units["torque"]
for one in simulation:
    time: NDArray[np.float64] = one.time

worst: nrs.WorstFound = study.worst_case()
force: float = worst.worst["force"]

page: str = study.report("page.html")
exported: nrs.Exported = study.export()
audit: nrs.Audit = study.audit("run.csv", decision.save("."))
first: nrs.AuditCheck | None = audit.first
recheck: nrs.Recheck = nrs.verify("soft-tissue.cert.json", "soft-tissue.nrs.yaml")
fault: str | None = recheck.fault
check: nrs.LyapunovCheck = nrs.check_lyapunov([[[-1]]], [[1]])
"""

# An expression, and what it is; `Any` of JSON documents stands in `to_dict` alone.
REVEALED = {
    "nrs.load": "def (path: str | pathlib.Path) -> nrs_design.api.study.Study",
    "nrs.identify('x')": "nrs_design.api.identified.Identification",
    "study.optimize()": "nrs_design.api.optimum.Optimum",
    "study.certify()": "nrs_design.api.decision.Decision",
    "study.simulate()": "nrs_design.api.simulation.Simulation",
    "study.simulate()[0]": "nrs_design.api.simulation.ScenarioRun",
    "study.simulate()['a']": "nrs_design.api.simulation.ScenarioRun",
    "study.audit('x')": "nrs_design.api.audit.Audit",
    "study.export()": "nrs_design.api.exported.Exported",
    "study.worst_case()": "nrs_design.api.worst.WorstFound",
    "study.report()": "str",
    "nrs.verify('x')": "nrs_design.api.recheck.Recheck",
    "nrs.check_lyapunov([], [])": "nrs_design.api.lyapunov.LyapunovCheck",
    "study.certify().plot()": "matplotlib.figure.Figure",
    "study.audit('x').checks": "tuple[nrs_design.api.audit.AuditCheck, ...]",
    "nrs.identify('x').ranges['k'].low": "float",
    "nrs.verify('x').claims": "tuple[str, ...]",
    "study.certify().to_dict()": "dict[str, Any]",
}


def mypy(folder, text):
    (folder / "user.py").write_text(text, encoding="utf-8")
    cache = ROOT / ".mypy_cache" / "user"
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={cache}",
         "--follow-imports=silent", "user.py"],
        cwd=folder,
        env={"MYPYPATH": str(ROOT), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )  # fmt: skip
    return done.stdout


def test_the_whole_way_is_typed(tmp_path):
    lines = [f"reveal_type({expression})" for expression in REVEALED]
    said = mypy(tmp_path, "\n".join([WAY, *lines, ""]))
    assert re.findall(r": error: .*", said) == []
    revealed = re.findall(r'Revealed type is "(.*)"', said)
    plain = [text.replace("builtins.", "") for text in revealed]
    assert dict(zip(REVEALED, plain, strict=True)) == REVEALED


def test_a_slip_is_told_before_it_runs(tmp_path):
    said = mypy(
        tmp_path,
        "import nrs_design as nrs\n"
        "nrs.laod('x')\n"
        "nrs.load('x').certify().verdikt\n"
        "nrs.identify(3)\n"
        "nrs.load('x').simulate()['a'].time.shap\n",
    )
    assert [int(line) for line in re.findall(r"user\.py:(\d+): error", said)] == [2, 3, 4, 5]
