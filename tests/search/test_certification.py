"""Nouns of the search, which commands need before they know whether they compute anything."""

import subprocess
import sys

import pytest

from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.method import Method
from tests.support import dayawansa_martin


@pytest.mark.parametrize(
    "module",
    ["search.certification", "search.margin", "pipeline", "api", "gating.run", "models.plant"],
)
def test_nouns_are_imported_without_numpy(module):
    code = f"import sys, nrs_design.{module}; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


def test_the_deciding_statement_is_the_evidence():
    proved = certify(dayawansa_martin(5), Method.LMI, Limits(optimize_rate=False))
    assert proved.evidence is proved.statements[0]
    nothing = certify(dayawansa_martin(6), Method.LMI, Limits(optimize_rate=False))
    assert (nothing.evidence, nothing.statements) == (None, ())
