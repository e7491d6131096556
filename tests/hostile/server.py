"""Runs commands in copies of one process that has loaded the program: a start costs nothing then.

Each order is a line on stdin, and the exit code of its command a line on stdout. A copy is a
process of its own: its time, its memory and its folder are nobody else's.
"""

import json
import os
import re
import sys
import time
from pathlib import Path

import numpy as np  # noqa: F401
import scipy.linalg  # noqa: F401

import nrs_design.pipeline.certification  # noqa: F401
from nrs_design.cli import main
from nrs_design.cli.app import make_app


def become(order: dict) -> None:
    """Turn this copy into a process that a user started."""
    os.chdir(order["folder"])
    os.environ |= order["environment"]
    for number, name in ((0, os.devnull), (1, order["out"]), (2, order["err"])):
        flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC if number else os.O_RDONLY
        os.dup2(os.open(name, flags), number)
    sys.argv = ["nrs-design", *order["arguments"]]


def run(order: dict) -> None:
    become(order)
    try:
        main()
    finally:
        status = Path("/proc/self/status").read_text()
        peak = int(re.search(r"VmHWM:\s+(\d+)", status)[1]) / 1024
        needs = {"seconds": time.process_time(), "mebibytes": peak}
        Path(order["needs"]).write_text(json.dumps(needs))


if __name__ == "__main__":
    make_app()
    for line in sys.stdin:
        child = os.fork()
        if not child:
            run(json.loads(line))
        _, status = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)
