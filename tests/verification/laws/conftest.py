"""Random problems and samples of the sliding rules, which the verification tests start from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import pytest

from anisocontact.base import registry

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Slides:
    """Trial forces outside their yield ellipses: S, F (n, 2, 2), T_tr (n, 2), N (n,)."""

    stiffness: Floats
    friction: Floats
    trial: Floats
    pressure: Floats

    def __iter__(self):
        return iter((self.stiffness, self.friction, self.trial, self.pressure))

    def size(self, t: npt.NDArray) -> npt.NDArray:
        """|t|_F/N of covectors (n, 2)."""
        return np.sqrt(np.einsum("ni,nij,nj->n", t, self.friction, t)) / self.pressure


def rotation(angle: npt.ArrayLike) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)


def positive(angle: Floats, values: Floats) -> Floats:
    """Tensors with the eigenvalues (n, 2), the first along `angle`."""
    q = rotation(angle)
    return np.einsum("nij,nj,nkj->nik", q, values, q)


def _random_slides(
    n: int,
    seed: int,
    *,
    condition: float = 1e2,
    ratio: tuple[float, float] = (1e-4, 0.999),
    aligned: bool = False,
) -> Slides:
    """Random tensors of at most this condition, N between these parts of |T_tr|_F."""
    r = np.random.default_rng(seed)
    half = np.log10(condition) / 2.0

    def tensor() -> Floats:
        angle = np.zeros(n) if aligned else r.uniform(0.0, np.pi, n)
        return positive(angle, 10.0 ** r.uniform(-half, half, (n, 2)))

    s, f, turn = tensor(), tensor(), r.uniform(0.0, 2.0 * np.pi, n)
    t = np.stack([np.cos(turn), np.sin(turn)], -1)
    part = 10.0 ** r.uniform(*np.log10(ratio), n)
    return Slides(s, f, t, part * np.sqrt(np.einsum("ni,nij,nj->n", t, f, t)))


@pytest.fixture(scope="session")
def random_slides() -> Callable[..., Slides]:
    return _random_slides


@dataclass(frozen=True)
class Rule:
    """A registered sliding rule with values of its parameters.

    `isotropic` are values with which the rule is isotropic where B and F are.
    """

    name: str
    parameters: dict[str, object] = field(default_factory=dict)
    isotropic: dict[str, object] | None = None

    @property
    def label(self) -> str:
        return "-".join([self.name, *(v for v in self.parameters.values() if isinstance(v, str))])


# A new rule: its name here, with values for its parameters.
SAMPLES: dict[str, list[Rule]] = {
    "maximum-dissipation": [Rule("maximum-dissipation")],
    "linear": [Rule("linear")],
    "coaxial": [Rule("coaxial")],
    "slip-ellipse": [
        Rule(
            "slip-ellipse",
            {"slip_axes": (3.0, 1.0), "slip_angle": 0.7},
            isotropic={"slip_axes": (1.3, 1.3), "slip_angle": 0.7},
        )
    ],
    "radial": [Rule("radial")],
    "explicit": [
        Rule("explicit", {"history": h}) for h in ("centre", "incremental", "kuhn-tucker")
    ],
}


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test that asks for a `rule` for every sample of every registered rule."""
    if "rule" in metafunc.fixturenames:
        names = [e.name for e in registry.sliding_rules()]
        rules = [r for name in names for r in SAMPLES.get(name, [])]
        metafunc.parametrize("rule", rules, ids=[r.label for r in rules])


@pytest.fixture(scope="session")
def samples() -> dict[str, list[Rule]]:
    """The samples by the name of the rule."""
    return SAMPLES
