"""The kinds of assumptions: within what each must hold, what breaks otherwise, how to test it.

docs/certificates/taken-for-granted.md says the same in prose.
"""

from __future__ import annotations

from nrs_design.switched.assumption import AssumptionKind, Standing

_AUDIT = "nrs-design audit LOG SPEC compares stays and transitions with the spec"

MOTOR = AssumptionKind(
    "the motor is linear, in its ranges",
    "gain and time constant of the spec",
    "Motors outside are not covered.",
    "nrs-design identify actuator on steps and sinusoids",
)
NOMINAL_MOTOR = AssumptionKind(
    "the motor is linear, and has no tolerance",
    "nominal gain and time constant of the spec",
    "Another gain or time constant is not covered.",
    MOTOR.test,
)
UNLOADED = AssumptionKind(
    "what is touched does not load the motor",
    "torque of contact far below that of the motor",
    "The motor is slower in contact than in the modes.",
    "nrs-design identify actuator on records in the air and in contact: one time constant",
)
LOAD = AssumptionKind(
    "the load acts against a known inertia",
    "the load inertia of the spec",
    "The motor meets another load than in the modes.",
    "step a known torque at a held command: the speed first changes by torque over inertia",
)
COMMAND_UNIT = AssumptionKind(
    "unit of the motor's command",
    "the unit of the spec",
    "All gains are wrong by the factor between the units.",
    "read it back from the controller, or check the code that is generated",
    Standing.ARGUED,
)
SPRING = AssumptionKind(
    "spring of the admittance",
    "position reference as described",
    "The spring draws to another place than in the modes.",
    "log reference and command across switches",
    Standing.ARGUED,
)
INPUTS = AssumptionKind(
    "inputs are zero, or bounded where that is said",
    "zero, or the bounds of the spec's disturbances",
    "Points of rest move; how far states then go is not said.",
    "log command and reference, against the spec; what the law subtracts from the force: one value",
)
FRICTION = AssumptionKind(
    "friction keeps its sign over a period",
    "one period",
    "The bound under friction may be left.",
    "log the speed: it must not reverse within a period",
)
AT_SAMPLES = AssumptionKind(
    "the bound is at the samples",
    "times of sampling",
    "Between two samples the force may be larger.",
    "log the force faster than the law runs",
)
UNCOUPLED = AssumptionKind(
    "axes do not act on each other",
    "zero coupling",
    "Another axis may take the place of an input, and feed back.",
    "command one axis with a step, and read the others' errors",
)
LINKS = AssumptionKind(
    "links stay within their bounds",
    "inertia and torques that are declared",
    "Axes may drive each other further than the proof allows.",
    "nrs-design robot at the poses that are used",
)
JOINT_SPEED = AssumptionKind(
    "joint speeds stay below their bound",
    "the speed up to which Coriolis torques are counted",
    "Coriolis torques may be larger than the proof allows.",
    "log the joint speeds; of a sampled loop, `nrs-design export --format monitor` checks them "
    "while it runs",
)
GRAVITY = AssumptionKind(
    "gravity is compensated",
    "its declared change over poses",
    "Gravity is a spring or a push that no mode holds.",
    "read the motors' torques at rest in the poses that are used",
)
TOUCHED_ALONE = AssumptionKind(
    "each axis is touched by itself",
    "no torque from the deflection of another axis",
    "Tissue couples the axes, which is not modelled.",
    "push one axis into the tissue, and read the torques on the others",
)
CONTACTS = AssumptionKind(
    "nothing else is touched",
    "the contacts that the spec lists for a controller",
    "Any other contact is a mode that nothing is said about.",
    "by procedure; nrs-design audit LOG SPEC estimates the stiffness met with each controller",
)
TISSUE = AssumptionKind(
    "environments follow their models in their ranges",
    "the ranges of the spec",
    "A stiffness outside, or a force of another form, is not covered.",
    "nrs-design identify tissue on presses at several places, depths and speeds",
)
PRELOAD = AssumptionKind(
    "the deflection stays within its preload",
    "the preload of the environment",
    "Beyond the preload the force is not that of the ranges; nothing is said.",
    "log the deflection, counted from the surface: its least and its largest value",
)
LINEARIZED = AssumptionKind(
    "motions about a linearization are small",
    "the deflections that were fitted",
    "Larger motions meet another stiffness than those of the range.",
    "log the deflection and compare it with the records",
)
MEMORY = AssumptionKind(
    "the memory of tissue is continuous",
    "as the law of the environment says",
    "Switches kick the state of the tissue.",
    "fit records of holding and release: nrs-design identify tissue",
)
CONTACT_KEPT = AssumptionKind(
    "contact is kept",
    "a torque of contact above zero at all times",
    "Free motion is a mode that nothing is said about.",
    "log the force: it must not reach zero",
)
CONTACT_LOST = AssumptionKind(
    "contact is lost as described",
    "a surface that is back in its place at once",
    "A surface that lags behind meets the axis elsewhere than in the modes.",
    "film or log a release: the surface must return faster than the axis",
)
AT_A_SWITCH = AssumptionKind(
    "what a switch does to the state",
    "no jump beyond those that are named",
    "A jump at a switch adds up over fast switching.",
    "log position, velocity and vm across a switch: no jump but those named",
    Standing.ARGUED,
)
IDLE = AssumptionKind(
    "what idle states do",
    "decay of the spec while another controller is active",
    "A stale state is a jump at the next switch.",
    "log velocity and reference of the admittance while another controller is active",
    Standing.ARGUED,
)
REST_POSITION = AssumptionKind(
    "where position is counted from",
    "rest of the contact",
    "The axis comes to rest elsewhere, with another force.",
    "hold the axis in contact: commanded and measured position and the force at rest",
    Standing.ARGUED,
)
ANY_SIGNAL = AssumptionKind(
    "how controllers may be switched",
    "none: every signal is covered",
    "Nothing: there is no rule to break.",
    "not needed",
    Standing.ARGUED,
)
RULES = AssumptionKind(
    "the rules of switching are kept",
    "the rules of the spec",
    "A faster or other switch is outside of what is proved.",
    _AUDIT,
)
LOGIC = AssumptionKind(
    "the mode logic keeps its times",
    "thresholds, noise and speeds of the spec",
    "Switches come earlier, or a wrong controller stays longer.",
    f"{_AUDIT}; log the signals: their noise, age and rates",
    Standing.ARGUED,
)
NOT_SAMPLED = AssumptionKind(
    "no sampling, friction or saturation",
    "delays far below the delay margin; commands below the limit of the driver",
    "The loop has dynamics that no mode holds; delay can destabilize it.",
    "declare sampling in the spec; log the command: it must stay below the driver's limit",
)
NOT_SAMPLED_BUT_LIMITED = AssumptionKind(
    "no sampling or friction, and saturation only as stated",
    "delays far below the delay margin",
    "The loop has dynamics that no mode holds; delay can destabilize it.",
    "declare sampling in the spec; log the command: cut off at the limits of the spec or beyond",
)
NOT_QUANTIZED = AssumptionKind(
    "no quantization, friction or saturation",
    "steps of the sensors far below the signals; commands below the limit of the driver",
    "Small motions may go on; behind a limit the loop is open.",
    "hold the axis in contact and log the command: no lasting motion, and below the limit",
)
LIMITED = AssumptionKind(
    "what saturates, and where",
    "the limits of the spec",
    "Motions that begin within the stated region may leave it.",
    "log velocity command, motor command and speed: cut off at the limits of the spec or beyond",
)
PERIOD = AssumptionKind(
    "no jitter",
    "the period of the spec, exactly",
    "The modes are those of another period; a longer one may be unstable.",
    "log the time of every tick: nrs-design audit LOG SPEC",
)
SAMPLE_AGE = AssumptionKind(
    "age of the force sample",
    "the samples that are named",
    "An older sample is dead time that no mode holds.",
    "nrs-design identify delay LOG --command RAW --measured USED",
)
SENSOR = AssumptionKind(
    "the force signal",
    "filter and errors of the spec",
    "An error of the force moves the point of rest, or adds a lag.",
    "nrs-design identify tool, and the data sheet of the sensor",
)
COVERAGE = AssumptionKind(
    "what an identified range holds",
    "the coverage that is named, for such specimens or motors",
    "Specimens or motors outside the coverage are not covered.",
    "identify one specimen or motor more: its parameters must lie within the ranges",
)
DOUBT = AssumptionKind(
    "the identification is in doubt",
    "the doubts that are listed",
    "The true values may lie outside the ranges, and then nothing is said about them.",
    "record what the doubt asks for, and identify again",
)
NUMBERS = AssumptionKind(
    "numbers on the robot are those listed",
    "the last bit",
    "The proof is about other gains.",
    "nrs-design verify CERT SPEC --deployed FILE",
    Standing.ARGUED,
)
ARITHMETIC = AssumptionKind(
    "arithmetic rounds as stated",
    "operations that are counted, and the largest angle",
    "Rounding may add up to more than is allowed for.",
    "count the operations in the source; maximum of a log of the angle",
    Standing.ARGUED,
)
RANGE = AssumptionKind(
    "a gain or parameter stays in its range",
    "the range of the spec",
    "Values outside are not covered.",
    "log the gain, or measure the parameter: in its range; one value where that is said",
)
MATRICES = AssumptionKind(
    "the matrices describe the system",
    "the matrices of the spec, exactly",
    "Nothing of the statement holds.",
    "identify the system, and compare with the matrices",
)
