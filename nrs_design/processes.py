"""Starts every other program and worker: none imports or runs what lies in the working folder.

That may be a stranger's, as the checkout is that a gate judges.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from joblib import Parallel

# Python that is started, by whatever it is, then leaves the working folder out of `sys.path`.
SAFE_PATH = {"PYTHONSAFEPATH": "1"}


def run_program(
    program: str, arguments: Sequence[str], folder: str | Path
) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder that holds what this process has put there, and nothing else."""
    return subprocess.run(
        [os.path.abspath(program), *arguments],
        cwd=folder,
        env=os.environ | SAFE_PATH,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        errors="replace",
    )


def workers(jobs: int, begin: Callable[..., object], *arguments: object) -> Parallel:
    """Return so many workers, of which each begins with a call, and gives results as they come.

    They and what keeps track of them start at any time from here on, so the rule stays.
    """
    os.environ |= SAFE_PATH
    from joblib import Parallel

    return Parallel(
        n_jobs=jobs,
        backend="loky",
        return_as="generator_unordered",
        initializer=begin,
        initargs=arguments,
    )
