"""The catalogue of rules: what each finding means, and what to do about it.

Ids are stable: they stand in lock files, annotations, baselines of code scanners and in the
``rule`` of every error in `nrs_design.errors`. An id is never given a second meaning.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Rule:
    """One kind of finding."""

    id: str  # Such as ``NRS102``
    title: str  # What should be the case, in a few words
    explanation: str  # What the rule means and how it is decided
    remedy: str  # What to do if it is broken

    @property
    def heading(self) -> str:
        """Its id and title."""
        return f"{self.id}: {self.title}"


@dataclass(frozen=True, slots=True)
class Word:
    """One word that an obligation can end with: what it means, and what to do then."""

    word: str
    explanation: str
    remedy: str

    @property
    def heading(self) -> str:
        """The word itself."""
        return self.word


COMMAND = Rule(
    "NRS000",
    "The command can be carried out",
    "What the command was asked to do is not possible with what it was given.",
    "Follow the message; `nrs-design COMMAND --help` shows an example of every command.",
)
SPEC = Rule(
    "NRS001",
    "The spec can be read",
    "A spec is a YAML file with exact numbers and units. It is read strictly: an unknown key, a "
    "number without its unit, a duplicate or an impossible value is an error, never a guess. In "
    "one run of the gate, every spec has a name of its own, because its files are named after it.",
    "Correct the place that is named by line and column; `nrs-design schema` describes the format.",
)
DESIGN = Rule(
    "NRS002",
    "The design problem has an answer",
    "The requirements of the spec cannot be met within the bounds that it sets, or the command "
    "needs a design where the spec gives matrices.",
    "Widen the bounds on the gains, or relax the requirement that is named.",
)
ASSEMBLY = Rule(
    "NRS003",
    "The modes make one switched system",
    "All modes must share one state. Loops with and without virtual inertia, for example, have "
    "states of different sizes, so no statement about switching between them is possible.",
    "Make the controllers alike (all with Mt > 0 or all without), or write one spec for each kind.",
)
CERTIFICATE = Rule(
    "NRS004",
    "The certificate or lock file can be read",
    "The file is missing, is not of the expected format, or does not belong to the spec that it "
    "is held against.",
    "Make it anew with `nrs-design certify-switching` or `nrs-design gate`; never edit it.",
)
OUTPUT = Rule(
    "NRS005",
    "The results can be written",
    "Results are written whole or not at all, never through a symbolic link, and never over a "
    "file of another spec or one that is not a result of nrs-design.",
    "Choose another place with --out or --reports, give the spec a name of its own, or make the "
    "folder writable.",
)
DATA = Rule(
    "NRS006",
    "The measured data can be used",
    "Records for identification are CSV files with named columns in known units, finite numbers, "
    "time that advances without gaps, and sensors within their range. What is wrong with a record "
    "is named with its row; nothing is filled in or left out silently.",
    "Mend or cut the record at the row that is named; --map gives foreign columns our names.",
)
POSE = Rule(
    "NRS007",
    "The robot can take the pose",
    "Every leg reaches its coupler's end with its crank and coupler only between folded and "
    "stretched. The message names the leg and by how much it is overstretched or folded too far.",
    "Choose a pose inside the workspace; `nrs-design robot kinematics SPEC` maps it.",
)
CLOCK = Rule(
    "NRS008",
    "The clock does not stop the work",
    "What a search may do is counted in units of work, of about a second each, so that its "
    "outcome does not depend on how fast a machine is or what else it does. The clock is a fuse: "
    "after ten seconds for each unit of the budget, and a minute more, it stops everything. Then "
    "nothing is decided, and no rate is claimed that more time would have raised. Exit code 3.",
    "Run it again where less else runs, or with a larger --budget, which allows more time, too.",
)
MODE_STABLE = Rule(
    "NRS101",
    "Every mode is stable",
    "Staying in one mode forever is an admissible switching signal, whatever the dwell time and "
    "the transitions that the spec declares, so every mode must be Hurwitz (all eigenvalues in the "
    "left half plane) or, in discrete time, Schur (inside the unit circle). Only a mode with a "
    "longest dwell time need not be: it must be left. Decided in exact arithmetic from the "
    "characteristic polynomial.",
    "Look at the eigenvalue and at the signs of this mode's matrix; for a controller, add damping "
    "(raise Bt), lower Kp, or narrow the range of the environment. Of the rules of switching, only "
    "a longest dwell time allows an unstable mode, if the machine leaves the mode by then.",
)
SWITCHING_STABLE = Rule(
    "NRS102",
    "The system is stable under the declared switching",
    "Every solution must decay exponentially, whatever the order and the times of the switches "
    "that the spec allows. Proved by a Lyapunov function: one quadratic function for all modes, or "
    "where none exists a polynomial of higher degree, or one quadratic function for each mode "
    "where switching is constrained, or one that depends on a constant parameter. Refuted by an "
    "unstable mode, by an average of modes that is not stable, or by a periodic switching signal "
    "that makes a motion grow, also at one value of a constant parameter; where contact may be "
    "lost, by a motion that grows and is in contact and free as it says itself. Whatever it is, it "
    "has passed an exact check. Stable modes alone do not suffice, and that no common quadratic "
    "function exists refutes nothing.",
    "If refuted by a mode, mend that mode first (NRS101). If refuted by a signal, take it away: "
    "declare a longer dwell time or only the transitions that really occur (not beside "
    "`sampling`), narrow the ranges, let force samples have one age, the oldest (`delay: 2` in "
    "place of [1, 2]: hold fresh ones back), or add damping (raise Bt). If inconclusive, neither "
    "was found: do the same, or search longer "
    "with a larger --budget, more --memory or a higher --max-degree, whichever the message says "
    "has ended the search (certify-switching, report and gate take them, and a spec says budget "
    "and max_degree under `certification`); certify-switching --margin finds the largest box of "
    "ranges with a proof, --shortest-dwell the shortest dwell time. The gate fails until there is "
    "a proof.",
)
STIFFNESS_RANGE = Rule(
    "NRS103",
    "The declared stiffness is below the stiffness limit",
    "For every impedance controller, the whole declared stiffness range of the environment that "
    "it is designed for lies below the stiffness at which the loop that is proved first becomes "
    "unstable, that stiffness being constant (damping held, or in viscoelastic contact all "
    "parameters in proportion), at every corner of the ranges of damping and motor and at "
    "every age of a force sample. A "
    "design goal, computed in floating point: not a proof. It is of contact that is kept: with "
    "`contact: losable` a range that reaches the limit is inconclusive. What is proved about the "
    "ranges is NRS102, at every corner of the parameter box and so inside it.",
    "Raise Bt or its upper bound, or narrow the stiffness range to what really occurs.",
)
GOAL = Rule(
    "NRS106",
    "The design meets its goal",
    "Every goal that the spec sets for a controller is met by the gains that ship: a margin of the "
    "loop that is proved at the nominal values and at every corner of the ranges of all "
    "contacts and the motor, sampled at every age of the force sample; the error of the "
    "displayed impedance or of the steady force at the nominal values and at every corner of the "
    "ranges of the environment that it is designed for; the creep in free "
    "motion. It is met where that is proved of all values in the ranges, each of them constant, "
    "where nothing has a range, and where the measure is worst at a corner; the last two are "
    "computed in floating point. It is inconclusive where corners meet it, and no proof covers "
    "what is between: of sampled loops with ranges there is none yet. It is missed where a corner, "
    "or a point between, misses it. "
    "docs/design/goals.md defines every goal.",
    "Let `nrs-design optimize` choose gains that are given, widen their bounds, narrow the ranges, "
    "or relax the goal.",
)
CERTIFIED_GOAL = Rule(
    "NRS108",
    "The certificate shows the goal",
    "The goals `peak_torque`, `decay_rate`, `delay` and `initial_force` are held against what is "
    "proved: the bound on the force in contact under all disturbances of the spec at once, the "
    "decay rate, the age of the oldest force sample that the proof covers, and the contact force "
    "from which motions decay although signals saturate. Decided in exact arithmetic. A bound that "
    "is above the goal does not say that the goal is missed: the largest value that occurs may be "
    "smaller, above all where contact may be lost.",
    "Lower the disturbance (the claim says down to which one the limit is kept), choose gains with "
    "more damping, raise --budget, or relax the goal; for the delay, let `sampling.delay` reach "
    "that far.",
)
SCENARIO_LIMIT = Rule(
    "NRS109",
    "Simulated scenarios stay below their limits",
    "Every scenario that declares `limits` is simulated with the gains that ship, by the engine "
    "that `nrs-design simulate` takes for it, and its largest torque, deflection and speed are "
    "held against them. A run in floating point: it shows that a limit is exceeded, or that this "
    "one run exceeds none; it proves nothing about other runs. The bound that no run may exceed is "
    "`goals: {peak_torque: ...}` (NRS108). A run that was stopped early misses its limits. With "
    "--locked, scenarios are not simulated again: they end as they are locked.",
    "Look at the run with `nrs-design simulate SPEC --scenario NAME --out FOLDER`; command less, "
    "choose gains with more damping, or relax the limit.",
)
NOT_DOUBTED = Rule(
    "NRS107",
    "Identified values are not in doubt",
    "`nrs-design identify --write` notes beside the values why the records may not determine them "
    "(`doubts`). A proof about such values may be about another tissue or motor than the measured "
    "one. The gate fails on them, unless `accept_doubt` says in one line why they are used; that "
    "line is printed with the proof, among its assumptions.",
    "Record again as the doubt says, identify anew, or say why with `accept_doubt: REASON` beside "
    "the doubts.",
)
CERTIFICATE_HOLDS = Rule(
    "NRS104",
    "The certificate holds for its spec",
    "The certificate file is read back and re-checked from the spec alone, in exact arithmetic and "
    "without any solver: the matrices are assembled from the spec, the gains and the numbers of "
    "every statement come from the certificate, and every other field must follow from these.",
    "Make it anew with `nrs-design gate`. If a fresh certificate is rejected, report a defect.",
)
LOCKED = Rule(
    "NRS105",
    "The lock file agrees with the specs",
    "With --locked, every spec must have an entry with the hash of what it says now (comments and "
    "layout do not count), with the certificate and the gains that were locked, and designed by "
    "this version of nrs-design; and every locked spec must still exist and be examined. Goals "
    "that only a design can decide, such as NRS103, must be there, and end as they are locked: "
    "they are not computed again.",
    "Run `nrs-design gate` without --locked, look at what changed, and commit the new lock file "
    "together with its certificates; with --prune for specs that were removed.",
)
NOT_WEAKER = Rule(
    "NRS110",
    "Nothing is weaker than in the base",
    "With --against BASE, what the specs of BASE asked for is still asked for: no spec is gone, no "
    "range covers less, no goal, limit or disturbance is looser, nothing more is taken for granted "
    "(a dwell time, contact that is kept, a doubt that is accepted), and the certificate shows all "
    "that the one of BASE does: verdict, rate, bounds, what happens where contact is lost or "
    "numbers are rounded. What cannot be compared counts as weaker. A proof of a weaker spec is a "
    "proof, so no other rule sees this. What makes another robot or law, and versions, are listed "
    "as other changes, and break nothing.",
    "If it is meant, let somebody who may decide that say so where the change is reviewed: there "
    "is no option for it, because the change itself could set it. Otherwise, take it back.",
)
RESPONSE_GOAL = Rule(
    "NRS112",
    "The frequency response meets its goal",
    "The goals `transparency` (largest force of the hand over the velocity of the tool, in free "
    "motion) and `accuracy` (largest share by which the tool is off the commanded velocity) hold "
    "for every impedance controller, at every frequency of their band and at all values of the "
    "ranges of motor and what is touched, each of them constant. The response is a quotient "
    "of polynomials with exact coefficients, enclosed over the whole box. Proved by a bound; "
    "refuted by a frequency and values at which it is exceeded. What is not covered is said to be "
    "not judged, and the gate fails on it. docs/design/transparency.md has the details.",
    "Lower Bt for less impedance, narrow the band or the ranges, or relax the goal; where it is "
    "not judged, remove the goal.",
)
ROS_PARAMETERS = Rule(
    "NRS201",
    "The parameters of a ROS 2 controller are read as they are meant",
    "`nrs-design ros2 check` reads a parameter file as rcl_yaml_param_parser and the parameters "
    "that admittance_controller declares do: an integer is no floating-point number, lists have "
    "their length, numbers their bounds. What breaks this keeps the controller from starting.",
    "Correct the place that is named by line and column.",
)
ROS_AXIS = Rule(
    "NRS202",
    "Each axis of a ROS 2 admittance controller is stable with what it touches",
    "The law of ros2_controllers (an exponential filter of the force, symplectic Euler of mass, "
    "damping and stiffness, joint damping) is written as an exact difference equation with the "
    "rate of the file, the range of stiffness and the ages of the measurement that the command "
    "names; every age and every end of a range is a mode, in any order. Proved and refuted as "
    "NRS102. Axes are taken one by one, and the robot for one that follows its command.",
    "Lower the stiffness that is touched, the age of the measurement or the period; raise the "
    "mass or the damping (with stiffness 0 only joint_damping damps); raise filter_coefficient "
    "towards 1. The message says up to which stiffness there is a proof.",
)
ROS_OTHERS = Rule(
    "NRS203",
    "Every controller of a ROS 2 parameter file is decided",
    "`nrs-design ros2 check` knows admittance_controller of ros2_controllers, and broadcasters, "
    "which command nothing. Any other node may move the same robot, in front of an admittance "
    "controller or instead of it: nothing is said about that.",
    "Show by other means what it does to the robot; keep nodes that are no controllers in a file "
    "of their own; give the type of a node that is one.",
)
INTERNAL = Rule(
    "NRS900",
    "The program works as intended",
    "Two independent computations disagree, or the program met a case that it was not written "
    "for. This is a defect of nrs-design and says nothing about the spec: it is not a verdict.",
    "Report it with the spec and what `nrs-design -v certify-switching SPEC` prints.",
)

RULES: Mapping[str, Rule] = MappingProxyType(
    {
        rule.id: rule
        for rule in (
            COMMAND,
            SPEC,
            DESIGN,
            ASSEMBLY,
            CERTIFICATE,
            OUTPUT,
            DATA,
            POSE,
            CLOCK,
            MODE_STABLE,
            SWITCHING_STABLE,
            STIFFNESS_RANGE,
            CERTIFICATE_HOLDS,
            LOCKED,
            GOAL,
            NOT_DOUBTED,
            CERTIFIED_GOAL,
            SCENARIO_LIMIT,
            NOT_WEAKER,
            RESPONSE_GOAL,
            ROS_PARAMETERS,
            ROS_AXIS,
            ROS_OTHERS,
            INTERNAL,
        )
    }
)

# Ids of rules that there were; none of them is ever given to another rule.
RETIRED = frozenset({"NRS111"})

WORDS: Mapping[str, Word] = MappingProxyType(
    {
        word.word: word
        for word in (
            Word(
                "proved",
                "The statement holds for the matrices of the spec with the gains as they ship: its "
                "evidence passed an exact check. It says nothing beyond the listed assumptions.",
                "Nothing. Keep the certificate; `nrs-design verify CERT SPEC` re-checks it. "
                "Exit code 0.",
            ),
            Word(
                "refuted",
                "The statement is false, and a witness shows it, checked exactly: a mode that is "
                "not stable by itself, an average of modes that is not, a periodic switching "
                "signal along which a motion grows, or a value of a constant parameter with one of "
                "these. Where `contact: losable` is asked for, it is a sequence of contact and "
                "flight that a growing motion makes by itself; growth for which the environment "
                "would have to pull is no such witness.",
                "Mend the spec or the design: the message names the witness. A mode needs more "
                "damping (raise Bt) or a narrower range; a signal is also taken away by a longer "
                "dwell time or by fewer transitions, if the robot keeps to them. Exit code 1.",
            ),
            Word(
                "inconclusive",
                "Neither a proof nor a refutation was found. This is not a statement of "
                "stability, nor of instability, even where it is shown that no common quadratic "
                "function exists. `refuted in kept contact` beside it says that there is growth, "
                "but only with an environment that pulls as it pushes, which none does: where "
                "contact may be lost, that decides nothing. Near the rest position under a "
                "constant force that pushes in, it is how motions grow until contact is lost.",
                "Take one of the changes that certify-switching lists: this spec accepts each of "
                "them, and is proved then; those of gains come first. Or search longer: with a "
                "larger --budget, more --memory or a higher --max-degree (of certify-switching, "
                "report and gate), whichever the message says has ended the search. A gate fails "
                "closed. Exit code 3.",
            ),
            Word(
                "met",
                "A goal is reached that is not a statement of stability: a design goal computed in "
                "floating point, or the agreement of files.",
                "Nothing. Exit code 0.",
            ),
            Word(
                "missed",
                "A goal is missed that is not a statement of stability: a design goal computed in "
                "floating point, or the agreement of files.",
                "Read the rule that is named with it, by `nrs-design explain RULE`. Exit code 1.",
            ),
            Word(
                "error",
                "The question could not be asked: a file, the design or the assembly of the "
                "modes failed before there was a verdict.",
                "Correct what the message names. Exit code 2, or 4 for a defect of nrs-design.",
            ),
        )
    }
)
