"""Steps from a proof to the robot that only its user can take."""

from __future__ import annotations

# What must be shown, by the id of its result, and how.
STEPS = {
    "program.vectors": (
        "The source in program/ gives the exact outputs of all vectors, on the processor",
        "compile and run NAME_test.c on the processor of the robot",
    ),
    "program.binary": (
        "The binary on the robot is made of that source, with these gains",
        "nrs-design verify CERT SPEC --deployed FILE, and the hash of the binary that is loaded",
    ),
    "tool.independent-check": (
        "A program that shares nothing with this one accepts the certificate",
        "check_elsewhere.py of the documentation, or one of your own, on the certificate here",
    ),
}


def user_steps(program: object) -> tuple[str, ...]:
    """Return the ids of the steps to the robot: without a program, only what is about the tool."""
    return tuple(id for id in STEPS if program or not id.startswith("program."))
