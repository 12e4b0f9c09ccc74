"""A diagnosis in words."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seacrane.cosim.diagnosis import BondDiagnosis, Diagnosis, Trial

ITERATED = ("newton", "fixed-point")
"""Algorithms that repeat a step until inputs and outputs agree: they show which step the motion itself allows."""

WEAK = 0.1
"""Below this loop gain a coupling is resolved well by explicit exchange."""

IDLE = 1e-9
"""Bonds with less than this share of the power of the strongest one have moved nothing."""

WIDTH = 110
"""Letters in a line of words."""

LONGEST = 160
"""Letters of a message that are shown."""


def text(found: Diagnosis) -> str:
    """The table of runs, the table of bonds, and what follows from them."""
    said = (line for sentence in _verdict(found) for line in wrap(sentence, WIDTH, subsequent_indent="    "))
    return "\n".join([*_runs(found), "", *_bonds(found), "", *said])


def _runs(found: Diagnosis) -> Iterator[str]:
    yield f"{found.system}: {found.until:g} s, error against {found.reference}"
    closest = found.closest
    if closest is not None:
        yield (
            f"the run closest to the reference ({closest.algorithm}, {closest.step:g} s) differs by "
            f"{_percent(closest.error)}: errors are known to about that"
        )
    for note in found.notes:
        yield f"note: {note}"
    steps = sorted({t.step for t in found.trials})
    yield "error, rms in % of the signal's range, worst coupling (CPU time over simulated time below it):"
    yield f"  {'macro step':<22}" + "".join(f"{f'{1e3 * step:g} ms':>10}" for step in steps) + "     order"
    span = max(found.until, 1e-12)
    for name in dict.fromkeys(t.algorithm for t in found.trials):
        runs = {t.step: t for t in found.of(name)}
        order = found.order(name)
        cells = "".join(f"{_error(runs.get(step)):>10}" for step in steps)
        yield f"  {name:<22}{cells}{'-' if order is None else f'{order:.1f}':>10}"
        yield "  " + " " * 22 + "".join(f"{_cost(runs.get(step), span):>10}" for step in steps)
    for name, why in found.left_out.items():
        yield f"  {name:<22}left out: {why}"


def _bonds(found: Diagnosis) -> Iterator[str]:
    if not found.bonds:
        return
    shown = max((t for t in found.trials if t.stable and t.bonds), key=_how_telling, default=None)
    yield "bonds: loop gain by macro step, and what the coupling does to power and energy" + (
        f" ({shown.algorithm}, {1e3 * shown.step:g} ms)" if shown else ""
    )
    steps = sorted({h for b in found.bonds for h in b.gains})
    width = max(14, *(len(b.name) for b in found.bonds))
    head = "".join(f"{f'{1e3 * h:g} ms':>9}" for h in steps)
    yield f"  {'bond':<{width}}{head}{'residual':>12}{'of power':>10}{'energy error':>14}{'of moved':>10}"
    most = max((b.power for b in shown.bonds.values()), default=0.0) if shown else 0.0
    still = [b.name for b in found.bonds if not any(b.gains.values()) and not (shown and shown.bonds[b.name].power)]
    for bond in found.bonds:
        if bond.name in still:
            continue
        line = f"  {bond.name:<{width}}" + "".join(f"{bond.gains[h]:>9.2g}" for h in steps)
        if shown and shown.bonds[bond.name].power > IDLE * most:
            b = shown.bonds[bond.name]
            line += f"{_si(b.residual, 'W'):>12}{_share(b.residual, b.power):>10}"
            line += f"{_si(abs(b.energy_error), 'J'):>14}{_share(abs(b.energy_error), b.energy_moved):>10}"
        yield line
    if still:
        yield f"  no power passed through {', '.join(still)}"


def _verdict(found: Diagnosis) -> Iterator[str]:
    limiting = found.limiting
    if limiting is not None:
        yield from _limit(found, limiting)
    for name in ("jacobi", "gauss-seidel", "gauss-seidel-linear"):
        lost = next((t for t in found.of(name) if not t.stable), None)
        if lost is not None:
            kept = [t.step for t in found.of(name) if t.stable and t.step < lost.step]
            until = f"holds to {1e3 * max(kept):g} ms and " if kept else ""
            yield f"{name} {until}is unstable at {1e3 * lost.step:g} ms: {_lost(lost)}."
            iterated = next((t for t in found.of("newton") if t.step == lost.step and t.stable), None)
            if iterated is not None and iterated.error <= found.tolerance:
                yield f"Newton's method, which iterates each step, is off by {_percent(iterated.error)} only there."
    best = found.recommended
    wanted = _percent(found.tolerance)
    if best is not None:
        yield (
            f"For an error of at most {wanted} take {best.algorithm} with a macro step of {1e3 * best.step:g} ms: "
            f"{_percent(best.error)} measured, {_factor(best, found.until)} of CPU time per simulated second."
        )
        yield from _others(found, best)
    elif found.closest is not None:
        yield (
            f"No run kept to {wanted}. The closest was {found.closest.algorithm} with {1e3 * found.closest.step:g} ms: "
            f"{_percent(found.closest.error)}. Try shorter steps."
        )
    else:
        yield "No run was stable. Try shorter steps."


def _limit(found: Diagnosis, bond: BondDiagnosis) -> Iterator[str]:
    if not bond.gains:
        share = f"{100 * bond.share:.0f} %"
        yield f"The bond {bond.name} limits the step: {share} of the residual power of all bonds is its."
        return
    longest = max(bond.gains)
    gain = bond.gains[longest]
    say = f"The bond {bond.name} limits the step: a change that goes once around it in {1e3 * longest:g} ms comes back "
    yield (
        say
        + f"{gain:.2g} times as large"
        + (f", in {1e3 * bond.critical:.2g} ms as it went." if bond.critical else ".")
    )
    if bond.stiff:
        yield (
            "It is stiff: the motion could be followed with longer steps than explicit exchange bears, so that the "
            "exchange and not the motion limits the step."
        )
    elif gain > 1 and not any(found.of(name) for name in ITERATED):
        yield "Whether it is stiff was not measured: no algorithm that iterates (newton) was among those tried."
    elif gain > 1:
        yield (
            "It is not stiff for this motion: where its gain exceeds 1, the steps are too long for the motion as well."
        )
    elif gain > WEAK:
        yield "It is not stiff at these steps; the coupling is of moderate strength."
    else:
        yield "It is not stiff: the coupling is weak at all these steps, and explicit exchange is enough."


def _others(found: Diagnosis, best: Trial) -> Iterator[str]:
    """What the plain algorithm would cost for the same, and the longest step that keeps the tolerance."""
    plain = [t for t in found.of("gauss-seidel") if t.stable and t.error <= found.tolerance]
    if plain and best.algorithm != "gauss-seidel":
        cheapest = min(plain, key=lambda t: t.cpu_s)
        times = f"{cheapest.cpu_s / best.cpu_s:.2g}"
        yield f"Plain gauss-seidel keeps to it with {1e3 * cheapest.step:g} ms, at {times} times that cost."
    kept = [t for t in found.trials if t.stable and t.error <= found.tolerance and t.step > best.step]
    if kept:
        longest = max(kept, key=lambda t: (t.step, -t.cpu_s))
        yield (
            f"The longest step that keeps to it is {1e3 * longest.step:g} ms, with {longest.algorithm} "
            f"({longest.cpu_s / best.cpu_s:.2g} times that cost)."
        )


def _how_telling(trial: Trial) -> tuple[bool, bool, float]:
    return trial.algorithm == "gauss-seidel", trial.algorithm == "jacobi", trial.step


def _error(trial: Trial | None) -> str:
    if trial is None:
        return "-"
    return f"{100 * trial.error:.2g}" if trial.stable else "unstable"


def _cost(trial: Trial | None, span: float) -> str:
    return "" if trial is None or trial.failure else f"({trial.cpu_s / span:.2g})"


def _factor(trial: Trial, span: float) -> str:
    return _si(trial.cpu_s / span, "s")


def _lost(trial: Trial) -> str:
    if not trial.failure:
        return f"off by {_percent(trial.error)} of the range"
    return trial.failure if len(trial.failure) <= LONGEST else f"{trial.failure[:LONGEST].rpartition(' ')[0]} ..."


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def _share(part: float, whole: float) -> str:
    return f"{100 * part / whole:.2g} %" if whole else "-"


def _si(value: float, unit: str) -> str:
    """A number with its unit, in thousands or thousandths where that is shorter."""
    for factor, prefix in ((1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u")):
        if value >= factor:
            return f"{value / factor:.3g} {prefix}{unit}"
    return f"{value:.2g} {unit}"
