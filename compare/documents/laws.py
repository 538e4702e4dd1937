"""Whether an engine keeps the laws, as JSON: the audit of a run's steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .values.amounts import double, plain

if TYPE_CHECKING:
    from ..audit.audit import Audit, Defect, Violation
    from ..audit.fits import Fit


def laws_json(audit: Audit | None) -> dict[str, Any] | None:
    """An audit as the JSON of a comparison has it, under `laws`; None where no run was audited.

    A number that is infinite or not known is None.

    >>> from truebreak.compare.audit.audit import Audit
    >>> told = laws_json(Audit(True, impacts=3, flights=7))
    >>> told["kept"], told["impacts"], told["first"], told["sentence"]
    (True, 3, None, 'keeps the law in all of its 3 impacts and 7 flights')
    """
    if audit is None:
        return None
    return {
        "kept": audit.kept,
        "reason": audit.reason,
        "impacts": audit.impacts,
        "flights": audit.flights,
        "sentence": audit.sentence,
        "fit": None if audit.fit is None else _fit_json(audit.fit),
        "first": None if audit.first is None else _violation_json(audit.first),
        "violations": [_violation_json(violation) for violation in audit.violations],
        "counts": plain(audit.counts),
        "defects": [_defect_json(defect) for defect in audit.defects],
        "declared": plain(audit.declared),
        "phantoms": _phantoms_json(audit.phantoms),
        "horizon": audit.horizon,
    }


def laws_brief(audit: Audit | None) -> dict[str, Any] | None:
    """An audit in a row of many: whether the laws are kept, and what is found, or why it cannot be told.

    >>> from truebreak.compare.audit.audit import Audit
    >>> laws_brief(Audit(None, "no finer step was run")), laws_brief(Audit(True)), laws_brief(None)
    ({'kept': None, 'told': 'no finer step was run'}, {'kept': True, 'told': ''}, None)
    """
    return None if audit is None else {"kept": audit.kept, "told": audit.finding}


def _fit_json(fit: Fit) -> dict[str, Any]:
    return {
        "description": fit.what,
        "kind": fit.kind,
        "value": double(fit.value),
        "spread": double(fit.spread),
        "explained": fit.explained,
        "of": fit.of,
    }


def _violation_json(violation: Violation) -> dict[str, Any]:
    return {
        "kind": violation.kind,
        "event": violation.event,
        "time": double(violation.time),
        "bodies": list(violation.bodies),
        "size": double(violation.size),
        "room": double(violation.room),
    }


def _defect_json(defect: Defect) -> dict[str, Any]:
    return {
        "kind": defect.kind,
        "size": double(defect.size),
        "order": None if defect.order is None else double(defect.order),
        "finest": double(defect.finest),
        "step": double(defect.step),
        "of_step": defect.of_step,
    }


def _phantoms_json(phantoms: tuple[int, int, float] | None) -> dict[str, Any] | None:
    if phantoms is None:
        return None
    count, event, approach = phantoms
    return {"count": count, "event": event, "approach": double(approach)}
