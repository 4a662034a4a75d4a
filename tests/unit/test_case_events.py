"""Steps that end on an event in the case file: mistakes, what a run says, a run that goes on."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.case.run import Listener, run
from anisocontact.cli import main
from anisocontact.results.checkpoint import load_checkpoint

CASE = """
[mesh.box]
block = { origin = [0, 0, 0], size = [1, 1, 0.5], cells = [2, 2, 1] }

[material]
block = { model = "linear-elastic", E = 1000, nu = 0.3 }

[surface.floor]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "floor"
friction = { coefficients = 0.3 }

[[step]]
name = "press"
increments = 2
displacement = { "block.top" = { x = 0, y = 0, z = -0.01 } }
until = { reaction = "block.top", value = 10.0 }

[[step]]
name = "drag"
increments = 2
displacement = { "block.top" = { x = 0.05 } }
until = { contact = "block.bottom", event = "sliding" }

[[step]]
name = "on"
increments = 2
displacement = { "block.top" = { y = 0.01 } }
until = { contact = "block.bottom", event = "lost" }

[output]
pictures = false
probe = { middle = { point = [0.5, 0.5, 0.25] } }
"""
REACTION = 'reaction = "block.top"'
#: What holds the block beside its top, and the event of the first step.
HELD = {
    "support": ("", f"{{ {REACTION}, value = 10.0 }}"),
    "elastic support": (
        '[elastic_support."block.right"]\nnormal = 40\ntangential = 100',
        '{ reaction = "block.right", value = 0.2, along = [0, 0, 1] }',
    ),
    "both": ('[elastic_support."block.top"]\nnormal = 300', f"{{ {REACTION}, value = 10.0 }}"),
    "spring": (
        '[spring.up]\ngroup = "block.left"\nstiffness = [0, 10, 100]',
        '{ reaction = "up", value = 0.4 }\nanchor = { up = { y = -0.03 } }',
    ),
}


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ('event = "sliding"', 'event = "slides"', "step[1].until.event: "),
        (
            '"block.bottom", event',
            '"block.side", event',
            "given; allowed: block.bottom on floor, block.bottom",
        ),
        ('"block.bottom", event', '"x", event', "given; allowed: block.bottom on floor, "),
        ('reaction = "block.top"', 'reaction = "block.left"', "what holds the bodies: block.top"),
        (REACTION, 'probe = "mid"', "step[0].until.probe: "),
        (REACTION, 'probe = "middle", quantity = "stres"', "stres"),
        (REACTION, 'probe = "middle", quantity = "stress"', "there are: XX, YY, ZZ, XY, YZ, XZ"),
        (REACTION, 'probe = "middle", component = "XX"', "there are: none, it is a number"),
        (REACTION, 'reaction = "block.top", quantity = "stress"', "given without a probe"),
        (", value = 10.0", "", "step[0].until: with reaction one of value is needed"),
        (
            f"{REACTION}, ",
            "",
            "until: nothing given, one of contact, reaction, displacement, probe ",
        ),
        (REACTION, f'probe = "middle", {REACTION}', "until: reaction and probe given, one of"),
        (
            f"{REACTION}, value = 10.0",
            'probe = "middle"',
            "with von_mises at probe 'middle' one of",
        ),
        ("value = 10.0", "value = -10.0", "step[0].until.value: -10.0 given without along"),
    ],
)
def test_mistakes(refused: Callable[..., str], old: str, new: str, line: str):
    """Requirement: one line that says where, before the run."""
    assert line in refused(CASE, old, new)


class _Stops(Listener):
    """Ends a run after some accepted parts."""

    def __init__(self, after: int = 1000) -> None:
        self.left = after

    def accepted(self, accepted: Any, summary: Any) -> None:
        self.left -= 1

    def lost(self) -> str:
        return "enough" if self.left <= 0 else ""


@pytest.mark.parametrize(
    ("waited", "strategy"),
    [
        ("support", "direct"),
        ("elastic support", "direct"),
        ("both", "condensed"),
        ("spring", "direct"),
    ],
)
def test_run_that_goes_on(tmp_path: Path, waited: str, strategy: str):
    """The summary and the history say when events happened; stopped anywhere, a run goes on alike.

    Requirement: the same events and the same history, to the bit. Source: what a checkpoint keeps.
    """
    path = tmp_path / "case.toml"
    held, event = HELD[waited]
    case = CASE.replace(f"{{ {REACTION}, value = 10.0 }}", event)
    path.write_text(f'[solver]\nstrategy = "{strategy}"\n\n{held}\n{case}')
    whole = tmp_path / "whole"
    assert run(build(load(path)), whole, _Stops()).status == "done"
    expected = json.loads((whole / "summary.json").read_text())
    press, drag, lost = expected["events"]
    assert press["happened"] and drag["happened"] and not lost["happened"]
    assert 0.0 < press["time"] < 1.0
    assert lost["time"] == pytest.approx(drag["time"] + 1.0)
    assert any("step 'on': the step ends without its event" in w for w in expected["warnings"])
    rows = (whole / "history.csv").read_text().splitlines()
    for after in range(1, len(rows) - 1, 5):
        folder = tmp_path / f"part{after}"
        assert run(build(load(path)), folder, _Stops(after)).status == "stopped"
        checkpoint = load_checkpoint(folder)
        assert run(build(load(path)), folder, _Stops(), checkpoint).status == "done"
        assert json.loads((folder / "summary.json").read_text())["events"] == expected["events"]
        found = (folder / "history.csv").read_text().splitlines()
        assert len(found) == len(rows)
        assert found == rows


def test_nothing_is_left_to_stop_after_the_event_of_the_last_step(tmp_path: Path):
    """A run whose last step an event has ended is done, whatever asks it to stop then.

    Requirement: done, as where the last increment of a step is met. An interruption in the
    increment of the event said "stopped", and a run that went on from there had nothing to do.
    """
    path = tmp_path / "case.toml"
    path.write_text(
        CASE.split('[[step]]\nname = "drag"', maxsplit=1)[0] + CASE[CASE.index("[output]") :]
    )
    assert run(build(load(path)), tmp_path / "whole", _Stops()).status == "done"
    count = json.loads((tmp_path / "whole" / "summary.json").read_text())["steps"]
    assert run(build(load(path)), tmp_path / "out", _Stops(count)).status == "done"
    (event,) = json.loads((tmp_path / "out" / "summary.json").read_text())["events"]
    assert event["happened"] and event["time"] < 1.0
    assert run(build(load(path)), tmp_path / "part", _Stops(count - 1)).status == "stopped"


def test_stress_at_a_probe(tmp_path: Path):
    """A step that ends at a von Mises stress in the middle of the block.

    Requirement: the table of the probe has it there, to a thousandth, and summary.json the event.
    Source: the case. Tolerance: that of the event.
    """
    path = tmp_path / "case.toml"
    case = CASE.replace(REACTION, 'probe = "middle"').replace("value = 10.0", "value = 5.0")
    case = case.partition('[[step]]\nname = "drag"')[0] + CASE[CASE.index("[output]") :]
    quantities = 'middle = { point = [0.5, 0.5, 0.25], quantities = ["von_mises"] }'
    path.write_text(case.replace("middle = { point = [0.5, 0.5, 0.25] }", quantities))
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0
    rows = (tmp_path / "out" / "probes" / "middle.csv").read_text().splitlines()
    names, last = rows[0].split(","), rows[-1].split(",")
    assert float(last[names.index("von_mises")]) == pytest.approx(5.0, rel=1e-3)
    events = json.loads((tmp_path / "out" / "summary.json").read_text())["events"]
    assert "von_mises at probe 'middle' reaches 5" in json.dumps(events)
