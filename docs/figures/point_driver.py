"""Pictures of the pages on the point driver, from its examples.

Run: python docs/figures/point_driver.py
"""

from pathlib import Path

from anisocontact.case.trace import load_trace
from anisocontact.point import drive
from anisocontact.point.pictures import compare, path_on_surface

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "examples" / "point"


def main() -> None:
    """Draw all of them."""
    for name, example in (("point-screw", "screw_cylinder"), ("point-polar", "polar_plate")):
        case = load_trace(EXAMPLES / f"{example}.toml")
        history = drive(case.interface, case.load, case.group)
        figure = path_on_surface(history, case.interface, title=case.case.title)
        figure.savefig(HERE / f"{name}.png", dpi=75, metadata={"Software": None})
    case = load_trace(EXAMPLES / "rules.toml")
    runs = {"maximum-dissipation": drive(case.interface, case.load)}
    runs |= {label: drive(interface, case.load) for label, interface in case.compared}
    figure = compare(runs, case.interface, title=case.case.title)
    figure.savefig(HERE / "point-rules.png", dpi=90, metadata={"Software": None})


if __name__ == "__main__":
    main()
