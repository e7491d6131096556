"""SABBATH's exact check: all leading principal minors, in SymPy.

As ``python -m benchmarks.sylvester n`` it prints, of two modes of order n, whether SymPy accepts
the certificate and the seconds that this takes. SymPy computes with python-flint where that is
installed, as it always is beside this package, unless ``SYMPY_GROUND_TYPES=python`` is set.
"""

from __future__ import annotations

import os
import subprocess
import sys
from time import perf_counter

from sympy import Matrix

from benchmarks.families import stable_family, to_system
from benchmarks.measure import prove
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.system import SwitchedSystem

DECIMALS = 3


def proved_family(n: int, m: int) -> tuple[SwitchedSystem, FormsOnGraph]:
    """Return a random family, the same in every process, and the proof of its stability."""
    system = to_system(stable_family(n, m, seed=n * m), DECIMALS)
    evidence = prove(system).evidence
    assert isinstance(evidence, FormsOnGraph)
    return system, evidence


def accepts(system: SwitchedSystem, evidence: FormsOnGraph) -> bool:
    """Check all leading principal minors of Q and of the decreases, with rational numbers."""
    Q = Matrix(evidence.nodes[0].form) / 2**evidence.denominator_log2
    forms = [Q]
    for mode in system.modes:
        A = Matrix(mode.A.numerators) / mode.A.denominator
        forms.append(-(A.T * Q + Q * A) - 2 * evidence.rate * Q)
    return all(form[:k, :k].det() > 0 for form in forms for k in range(1, system.order + 1))


def check_apart(n: int, ground_types: str) -> tuple[bool, float]:
    """Check two modes in a process of its own, with these integers below SymPy."""
    command = [sys.executable, "-m", "benchmarks.sylvester", str(n)]
    environment = {**os.environ, "SYMPY_GROUND_TYPES": ground_types}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    accepted, seconds = done.stdout.split()
    return accepted == "True", float(seconds)


def main() -> None:
    system, evidence = proved_family(int(sys.argv[1]), 2)
    start = perf_counter()
    accepted = accepts(system, evidence)
    print(accepted, perf_counter() - start)


if __name__ == "__main__":
    main()
