"""``gate --locked``: re-check what was locked, without designing or solving anything."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design import __version__
from nrs_design.certificates.certificate import Certificate
from nrs_design.certificates.verify import verify
from nrs_design.gating.examine import Examiner, certified_rate
from nrs_design.gating.lock import Lock, LockedSpec, relative_to_lock
from nrs_design.gating.obligations import (
    Caution,
    GateOutcome,
    Obligation,
    SpecOutcome,
    Status,
    failed,
)
from nrs_design.gating.rules import (
    GOAL,
    LOCKED,
    RULES,
    SCENARIO_LIMIT,
    STIFFNESS_RANGE,
)
from nrs_design.progress import Progress, silent
from nrs_design.spec import LoadedSpec, RobotSpec, read_spec
from nrs_design.spec.goals import OF_THE_CERTIFICATE, ONLY_FOR
from nrs_design.spec.load import is_there

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec, Spec

RENEW = "run nrs-design gate without --locked"
PRUNE = "run nrs-design gate with --prune"
_AS_LOCKED = "(as locked; not computed again)"

# Requirement on a design: id of the rule, and subject.
GoalKey = tuple[str, str]
# A design without margins has this in the place of all that is asked of controllers.
_NO_MARGINS = (STIFFNESS_RANGE.id, "controllers")


def run_locked(
    specs: Sequence[Path],
    lock: Lock,
    file: Path,
    progress: Progress = silent,
    *,
    paths: Sequence[Path] = (),
) -> GateOutcome:
    """Re-check every spec against the lock file, exactly and without any solver.

    Paths in the lock are relative to it. Locked specs that no longer exist are part of the outcome,
    and so are those below a named folder that were not examined; those elsewhere are only noted.
    """
    entries = {entry.path: entry for entry in lock.specs}
    outcomes = []
    for number, path in enumerate(specs, start=1):
        progress(f"spec {number} of {len(specs)}")
        entry = entries.pop(relative_to_lock(path, file), None)
        outcomes.append(_examine_safely(path, entry, file))
    unnamed = []
    for name in sorted(entries):
        path = file.parent / name
        if not is_there(path):
            outcomes.append(_absent(path, f"is in {file.name}, but no longer exists ({PRUNE})"))
        elif _is_below(path, paths):
            message = f"is in {file.name}, but was not examined: it lies behind a link to a folder "
            outcomes.append(_absent(path, message + "or in a hidden folder (name it, or move it)"))
        else:
            unnamed.append(name)
    notes = (f"locked, but not among the given paths: {', '.join(unnamed)}",) if unnamed else ()
    return GateOutcome(tuple(outcomes), notes)


def _is_below(path: Path, named: Sequence[Path]) -> bool:
    """Tell whether a file is below one of the named paths, by its name or really."""
    roots = {form for one in named for form in _forms(one)}
    return any(not roots.isdisjoint((form, *form.parents)) for form in _forms(path))


def _forms(path: Path) -> tuple[Path, Path]:
    return Path(os.path.abspath(path)), Path(os.path.realpath(path))


def _examine_safely(path: Path, entry: LockedSpec | None, file: Path) -> SpecOutcome:
    try:
        return _examine(read_spec(path), entry, file)
    except Exception as error:
        # One spec must not keep the others from being examined, whatever goes wrong with it.
        return failed(path, error)


def _examine(loaded: LoadedSpec, entry: LockedSpec | None, file: Path) -> SpecOutcome:
    examiner = Examiner(loaded)
    if isinstance(loaded.spec, RobotSpec) and entry is None:
        return examiner.nothing_to_certify()
    if entry is None:
        return _missed(examiner, f"this spec is not in {file.name} ({RENEW})")
    if (changed := _find_change(loaded, entry)) is not None:
        return _missed(examiner, f"{changed} ({RENEW})")
    if lacks := find_missing(loaded.spec, {(g.rule, g.subject): g.status for g in entry.goals}):
        lacking = "; ".join(f"{rule} of {subject}" for rule, subject in lacks)
        return _missed(examiner, f"{file.name} does not say how this ended: {lacking} ({RENEW})")
    if entry.certificate is None:
        return _inconclusive(examiner, entry, file)
    place = Path(os.path.normpath(file.parent / entry.certificate.file))
    if not _is_below(Path(os.path.realpath(place)), [Path(os.path.realpath(file.parent))]):
        return _missed(examiner, f"{place.as_posix()} lies behind a link that leads elsewhere")
    checked = verify(place, loaded)
    if checked.certificate is None or checked.fault is not None:
        obligation = examiner.certificate(place, checked.fault or "it holds no claim")
        return SpecOutcome(loaded.path, (obligation,), loaded.sha256, certificate=place)
    certificate = checked.certificate
    if difference := _find_difference(certificate, entry):
        return _missed(examiner, f"{place.as_posix()} {difference} ({RENEW})")
    return _confirmed(examiner, certificate, entry, place, file)


def _find_change(loaded: LoadedSpec, entry: LockedSpec) -> str | None:
    """Say what has changed since a spec was locked."""
    if entry.sha256 != loaded.sha256:
        return "this spec has changed since it was locked"
    if entry.gains and entry.version != __version__:
        was = f"this spec was designed by nrs-design {entry.version}"
        return f"{was}, and this is {__version__}, which may design other gains"
    return None


def _confirmed(
    examiner: Examiner, certificate: Certificate, entry: LockedSpec, place: Path, file: Path
) -> SpecOutcome:
    found = (
        *examiner.stability(certificate.system, certificate.statements, "as locked"),
        examiner.certificate(place, None),
        *_other_goals(examiner, certificate, entry, file),
    )
    proof_items = (*examiner.contact(certificate), *examiner.limits(certificate))
    cautions = (*proof_items, *examiner.cautions(None), *_remark(examiner, entry))
    return examiner.outcome(certificate, place, certificate, found, cautions)


def _other_goals(
    examiner: Examiner, certificate: Certificate | None, entry: LockedSpec, file: Path
) -> tuple[Obligation, ...]:
    """Return the obligations beside stability."""
    agrees = examiner.obligation(LOCKED, "lock", Status.MET, f"as in {file.name}", ("name",))
    goals = (*examiner.certified_goals(certificate), *_goals(examiner, entry))
    return (*goals, *examiner.identified(), agrees)


def _goals(examiner: Examiner, entry: LockedSpec) -> Iterator[Obligation]:
    """Yield the obligations that only a design decides, with their locked status."""
    for goal in entry.goals:
        # A run is named by its scenario: `NAME: torque`.
        run = goal.rule == SCENARIO_LIMIT.id
        place = "scenarios", goal.subject.partition(":")[0], "limits"
        message, ended = f"{goal.message} {_AS_LOCKED}", Status(goal.status)
        keys = place if run else ("controllers", goal.subject)
        yield examiner.obligation(RULES[goal.rule], goal.subject, ended, message, keys)


def _remark(examiner: Examiner, entry: LockedSpec) -> Iterator[Caution]:
    """Yield the worst remark on the design, as it was locked."""
    if (found := entry.remark) is not None:
        caution = examiner.caution(f"{found.message} {_AS_LOCKED}", *found.at)
        yield replace(caution, beyond=found.beyond)


def _find_difference(certificate: Certificate, entry: LockedSpec) -> str | None:
    """Say how a valid certificate differs from what was locked."""
    if entry.certificate is None or certificate.id != entry.certificate.id:
        return "is not the certificate that was locked"
    if (certificate.verdict, certified_rate(certificate)[0]) != (entry.verdict, entry.rate):
        return "has another verdict or rate than the lock file says"
    if certificate.gains != entry.gains:
        return "is about other gains than the lock file says"
    return None


def _inconclusive(examiner: Examiner, entry: LockedSpec, file: Path) -> SpecOutcome:
    message = f"neither a proof nor a refutation is locked in {file.name}"
    others = _other_goals(examiner, None, entry, file)
    return SpecOutcome(
        path=examiner.loaded.path,
        obligations=(examiner.system(Status.INCONCLUSIVE, message), *others),
        sha256=examiner.loaded.sha256,
        verdict="inconclusive",
        common_quadratic="unknown",
    )


def _missed(examiner: Examiner, message: str) -> SpecOutcome:
    obligation = examiner.obligation(LOCKED, "lock", Status.MISSED, message, ("name",))
    return SpecOutcome(examiner.loaded.path, (obligation,), examiner.loaded.sha256)


def _absent(path: Path, message: str) -> SpecOutcome:
    relative = Path(os.path.relpath(path))
    obligation = Obligation(LOCKED, relative, "lock", Status.MISSED, f"this spec {message}")
    return SpecOutcome(relative, (obligation,))


def find_missing(spec: Spec, locked: Mapping[GoalKey, str]) -> tuple[GoalKey, ...]:
    """Return the requirements of a spec that the lock, with a status for each, lacks."""
    if spec.kind != "interaction-design":
        return ()
    # A design without margins, or a failed run, stands for all its goals, and is never met.
    unjudged = {one for one, status in locked.items() if status != "met"}
    goal_keys = () if _NO_MARGINS in unjudged else tuple(_controller_goals(spec))
    limits = (
        one for one in _scenario_goals(spec) if (one[0], one[1].split(":")[0]) not in unjudged
    )
    return tuple(one for one in (*goal_keys, *limits) if one not in locked)


def _scenario_goals(spec: InteractionDesignSpec) -> Iterator[GoalKey]:
    for name, scenario in spec.scenarios.items():
        for quantity in () if scenario.limits is None else scenario.limits.named:
            yield SCENARIO_LIMIT.id, f"{name}: {quantity}"


def _controller_goals(spec: InteractionDesignSpec) -> Iterator[GoalKey]:
    sampling = spec.sampling
    # A force that is sampled more often than the motion loop has no such limit.
    is_limited = sampling is None or sampling.outer >= sampling.period.exact
    for name, controller in spec.controllers.items():
        if controller.limits_stiffness and is_limited:
            yield STIFFNESS_RANGE.id, name
        given = (spec.goals, getattr(controller, "goals", None))
        keys = {key for goals in given if goals is not None for key, _ in goals.given()}
        for key in sorted(keys - OF_THE_CERTIFICATE):
            if "goals" in type(controller).model_fields and ONLY_FOR.get(key, controller.type) == (
                controller.type
            ):
                yield GOAL.id, f"{name}: {key}"
