"""docs/dev/how-to-add.md: a sliding rule written as the page says is one.

Requirement: the rule on the page compiles, is a `SlidingRule`, and its derivatives are those of its
`slide` in dual numbers. Tolerance: 1e-12 of numbers of size one, rounding; it is in the program.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

PROGRAM = """
#include <cstdio>
#include "anisocontact/law/rules/radial.hpp"

using namespace anisocontact;
using namespace anisocontact::law;

%s

static_assert(SlidingRule<Collinear>);

// Trial force, pressure and an angle that turns the tensors are the variables 0, 1; 2; 3.
template <class S>
SlideProblem<S> problem(const S& t1, const S& t2, const S& n, const S& angle) {
  SlideProblem<S> p{};
  const S one(1.0), two(2.0), mixed = S(0.3) + angle;
  p.stiffness = {{{{two, mixed}, {mixed, one}}}};
  p.friction = {{{{S(9.0), mixed * mixed}, {mixed * mixed, S(25.0)}}}};
  p.a_co = {{{{one, S(0.0)}, {S(0.0), one}}}};
  p.trial = {{t1, t2}};
  p.pressure = n;
  return p;
}

int main() {
  using D = Dual<4>;
  const Collinear rule;
  const auto v = [](double x, std::size_t i) { return D::variable(x, i); };
  const auto exact = rule.slide(problem<D>(v(1.0, 0), v(0.4, 1), v(0.7, 2), v(0.2, 3)));
  const auto p = problem<double>(1.0, 0.4, 0.7, 0.2);
  const auto r = rule.slide(p);
  const auto t = rule.tangent(p, r);
  using A = Dual<1>;
  const auto angle = problem<A>(A(1.0), A(0.4), A(0.7), A::variable(0.2, 0));
  const auto turned = rule.tensor_tangent(p, r, t, angle);
  double most = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double mine[] = {t.d_trial(i, 0), t.d_trial(i, 1), t.d_pressure[i], turned[0][i]};
    for (std::size_t k = 0; k < 4; ++k)
      most = std::max(most, std::abs(mine[k] - exact.traction[i].d[k]));
  }
  std::printf("%%g\\n", most);
  return most < 1e-12 ? 0 : 1;
}
"""


def rule_of_the_page() -> str:
    """The block of C++ with the rule, whole."""
    page = (ROOT / "docs/dev/how-to-add.md").read_text()
    (block,) = (b for b in re.findall(r"```cpp\n(.*?)```", page, re.S) if "tensor_tangent" in b)
    return block


@pytest.mark.slow
def test_rule_of_the_page(tmp_path) -> None:
    folders = [Path(p, "cmeel.prefix/include/eigen3") for p in sys.path]
    eigen = next(p for p in (*folders, Path("/usr/include/eigen3")) if (p / "Eigen/Core").is_file())
    compiler = os.environ.get("CXX", "").split() or [shutil.which("c++") or "g++"]
    source, program = tmp_path / "rule.cpp", tmp_path / "rule"
    source.write_text(PROGRAM % rule_of_the_page())
    command = [*compiler, "-std=c++20", "-O0", f"-I{ROOT / 'cpp/include'}", f"-isystem{eigen}"]
    subprocess.run([*command, str(source), "-o", str(program)], check=True)
    r = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert r.returncode == 0, r.stdout


def test_page_names_what_a_rule_needs() -> None:
    """Every member that the concept asks for is in the rule of the page, and in its text."""
    concept = (ROOT / "cpp/include/anisocontact/law/slide.hpp").read_text()
    asked = set(re.findall(r"r\.(\w+)\(|T::(\w+)\(", concept))
    members = {name for pair in asked for name in pair if name}
    page, rule = (ROOT / "docs/dev/how-to-add.md").read_text(), rule_of_the_page()
    assert {"slide", "tangent", "tensor_tangent", "describe"} <= members
    for member in members:
        assert re.search(rf"\b{member}\(", rule)
        assert f"`{member}`" in page
