"""The page of assumptions has a row for every kind that a certificate may take for granted."""

from nrs_design.switched import assumption_kinds as kinds
from nrs_design.switched.assumption import AssumptionKind
from tests.support import ROOT

# The beginning of its row; a signal that no rule restricts takes nothing for granted.
ROWS = {
    "MOTOR": "the motor is a linear actuator",
    "NOMINAL_MOTOR": "the motor is a linear actuator",
    "UNLOADED": "the tissue does not load the motor",
    "LOAD": "what is touched acts on the motor against a known inertia",
    "COMMAND_UNIT": "the command of the motor is in the unit",
    "SPRING": "the spring draws to",
    "INPUTS": "inputs are zero",
    "FRICTION": "friction keeps its sign",
    "AT_SAMPLES": "a bound on the force holds at the samples",
    "UNCOUPLED": "the axes do not act on each other",
    "LINKS": "the links stay within their bounds",
    "JOINT_SPEED": "the links stay within their bounds",
    "GRAVITY": "gravity is compensated",
    "TOUCHED_ALONE": "what is touched acts on each axis by itself",
    "CONTACTS": "nothing else is touched",
    "TISSUE": "environments follow their models",
    "PRELOAD": "the deflection stays within its preload",
    "LINEARIZED": "motions about the point of a linearization",
    "MEMORY": "tissue keeps its memory",
    "CONTACT_KEPT": "contact is kept",
    "CONTACT_LOST": "a lost surface is back in its place",
    "AT_A_SWITCH": "switches keep the state",
    "IDLE": "idle states are",
    "REST_POSITION": "position is counted from the rest",
    "RULES": "the rules of switching are kept",
    "LOGIC": "the rules of switching are kept, and the times of the mode logic",
    "NOT_SAMPLED": "no sampling, delay or quantization",
    "NOT_SAMPLED_BUT_LIMITED": "no saturation",
    "NOT_QUANTIZED": "no friction; no quantization",
    "LIMITED": "what saturates, and where",
    "PERIOD": "the law runs every period",
    "SAMPLE_AGE": "age of the force sample",
    "SENSOR": "the force signal has the filter",
    "COVERAGE": "an identified range holds",
    "DOUBT": "a doubt about an identification",
    "NUMBERS": "gains are those listed",
    "ARITHMETIC": "no term is rounded more often",
    "RANGE": "a parameter stays in its range",
    "MATRICES": "the matrices describe the system",
}


def test_every_kind_has_a_row():
    page = (ROOT / "docs/certificates/taken-for-granted.md").read_text(encoding="utf-8")
    made = {name for name, kind in vars(kinds).items() if isinstance(kind, AssumptionKind)}
    assert made == {*ROWS, "ANY_SIGNAL"}
    rows = [line for line in page.splitlines() if line.startswith("| ")]
    for name, beginning in ROWS.items():
        assert any(row.startswith(f"| {beginning}") for row in rows), name
