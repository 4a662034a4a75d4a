"""What is said of a run as soon as it happens, each once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from anisocontact.solver.stepping.cut_faces import PAST
from anisocontact.solver.stepping.report import Accepted
from anisocontact.solver.stepping.symmetry_watch import CROSSED
from anisocontact.solver.system.rotations import CURE, STRAINED, WARNED

#: What is said where penalties hold instead of multipliers.
RELAXED = (
    "the multipliers of the contacts did not converge, so this increment, and later ones like it, "
    "have penalties instead; the summary has the penetration"
)
#: What is said where the end of a master reaches nodes where penalties hold instead of multipliers.
SLIVERS = (
    "with less than 5% of the weight of a node opposite to the end of the master: a gap is "
    "extrapolated from there, and closing it can push the end away, so that there is no "
    "multiplier; take the side that does not reach beyond the other as the slave"
)
#: What is said of points whose pressure nothing says.
HELD = (
    "where supports hold both sides along the normal: no equilibrium says what the pressure is "
    "there, it is left to the penalty, zero where nothing overlaps, and what presses the sides "
    "together there is in the reactions of these supports alone"
)
#: What is said of a body at small strain that is strained far.
FAR = (
    "body {name!r}, at small strain, is strained by {strain:.2g} as a whole, and forces are off by "
    "a share of that size; {cure}"
)
#: What is said of a law that pushes along the slip.
DRIVEN = (
    "its law gave {share:.2g} of the work done so far where friction takes energy: a tangential "
    "force pushes along the slip, or a dissipation is returned with the wrong sign"
)
#: What is said of a material that gives energy.
FED = (
    "its material gave {share:.2g} of the work done so far where materials dissipate: what it says "
    "it has `dissipated` is negative"
)
#: What is said of a state that is in equilibrium and not stable.
UNSTABLE = (
    "the equilibrium is not stable, as beyond the load of buckling: its tangent has a negative "
    "eigenvalue, and the least disturbance leads to another one; a small load to one side while it "
    "is still stable leads there"
)
#: What is said of cells that are folded between the points where their material is asked.
FOLDED = (
    "body {name!r}: {cells} folded over at a corner (det F <= 0 there), the first at {place}: no "
    "body deforms so, and forces around it are none of its material; round off an edge "
    "that is pressed or dragged there, or take order 1 where cells are of order 2"
)
#: Forces out of balance, over those at work, from which on a state is none of equilibrium.
UNBALANCED = 1e-4


class IncrementWarnings:
    """Warnings that accepted increments give reason to."""

    def __init__(self) -> None:
        self._issued: set[str] = set()

    def of(self, accepted: Accepted) -> list[str]:
        """What has not been said before, with where it happened."""
        found = _placed(accepted, _summed_up(accepted)) | lasting(accepted)
        fresh = [text for key, text in found.items() if key not in self._issued]
        self._issued |= set(found)
        return fresh


def lasting(accepted: Accepted) -> dict[str, str]:
    """Warnings, by what they are about, of which the numbers of a run say nothing at its end.

    Args:
        accepted: An accepted increment.

    Returns:
        Where it happened and what, by a key that is the same each time.
    """
    return _placed(accepted, _unkept(accepted))


def _placed(accepted: Accepted, found: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Warnings with where they happened."""
    where = f"step {accepted.step!r}, increment {accepted.increment}"
    return {key: f"{where}: {text}" for key, text in found}


def missed_event(accepted: Accepted) -> str:
    """What is said of a step that ends without its event."""
    return f"the step ends without its event, {accepted.missed}: it took all its increments"


def _summed_up(accepted: Accepted) -> Iterator[tuple[str, str]]:
    """Reasons for a warning, by what they are about, of which a run keeps the worst or all."""
    for name, turned in accepted.turned.items():
        if turned.angle > WARNED:
            yield f"turned {name}", f"body {name!r}, at small strain, {turned}; {CURE}"
        if turned.strained > STRAINED:
            yield f"strained {name}", FAR.format(name=name, strain=turned.strained, cure=CURE)
    for name, lost in accepted.past_cuts.items():
        yield f"past {name}", f"contact {name!r}: {PAST.format(lost)}"
    if accepted.imbalance.large:
        yield "energy", str(accepted.imbalance)
    if accepted.residuals[-1] > UNBALANCED:
        share = f"{accepted.residuals[-1]:.2g} of the forces at work are out of balance"
        yield "unbalanced", f"{share}: the options snes_rtol and snes_atol let them be"
    if accepted.missed:
        yield f"missed {accepted.step}", missed_event(accepted)
    if accepted.relaxed:
        yield "relaxed", RELAXED


def _unkept(accepted: Accepted) -> Iterator[tuple[str, str]]:
    """Reasons for a warning, by what they are about, that nothing else of a run keeps."""
    if accepted.unstable:
        yield "unstable", UNSTABLE
    for behind in accepted.behind:
        yield f"behind {behind.body} {behind.master}", str(behind)
    for group, depth in accepted.crossed.items():
        name = group.partition(".")[0]
        yield f"crossed {group}", f"body {name!r} {CROSSED.format(group=group, depth=depth)}"
    for name, moved in accepted.across.items():
        yield from ((f"across {name} {one.plane}", f"contact {name!r}: {one}") for one in moved)
    for name, (count, place) in accepted.folded.items():
        cells = "a cell is" if count == 1 else f"{count} cells are"
        at = "({:.4g}, {:.4g}, {:.4g})".format(*place)
        yield f"folded {name}", FOLDED.format(name=name, cells=cells, place=at)
    for name, count in accepted.undetermined.items():
        points = "slave point touches" if count == 1 else "slave points touch"
        yield f"undetermined {name}", f"contact {name!r}: {count} {points} {HELD}"
    for name, share in accepted.imbalance.driven.items():
        yield f"driven {name}", f"contact {name!r}: {DRIVEN.format(share=share)}"
    for name, share in accepted.imbalance.driven_by.items():
        yield f"fed {name}", f"body {name!r}: {FED.format(share=share)}"
    for name, stride in accepted.rolled.items():
        yield f"rolled {name}", f"contact {name!r}: {stride}"
    for name, came in accepted.without_slip.items():
        yield f"without slip {name}", f"contact {name!r}: {came}"
    for name, faces in accepted.faces.items():
        yield from ((f"face {name} {one.body}", f"contact {name!r}: {one}") for one in faces)
    for name, count in accepted.slivers.items():
        nodes = "slave node touches" if count == 1 else "slave nodes touch"
        yield f"slivers {name}", f"contact {name!r}: {count} {nodes} {SLIVERS}"
