# `make run` and `make test` need nothing but make, a C++20 compiler and a Python >= 3.12.
.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help setup run test verify mutants wheel sanitize clang lint format bench scoreboard docs clean distclean

IN_VENV := tools/venv-run
EXAMPLE := milled_block
N :=
MARKS := not slow
CPP := $(shell find cpp src tests -name '*.hpp' -o -name '*.cpp' 2>/dev/null)

help: ## list the targets
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 20

setup: ## make .venv and build the core; quick when nothing changed
	@tools/setup

run: setup ## run the main example and say where its pictures are
	@$(IN_VENV) anisocontact run examples/$(EXAMPLE)/case.toml -o results/$(EXAMPLE) --overwrite
	@echo "pictures: results/$(EXAMPLE)/report.html   fields for ParaView: results/$(EXAMPLE)/*.pvd"

# Lint and tests at once; what lint has to say comes last. Tests of a file share what they solve; tests/conftest.py has files in the
# order in which no process is left alone with a long one. Durations are kept in build. A process that dies ends the run, which names its
# test: xdist 3.8 may wait for ever for one that it starts instead.
define tested
  mkdir -p build; $(MAKE) --no-print-directory lint >build/lint.log 2>&1 & lint=$$!; tests=; \
  $(IN_VENV) pytest -n auto --dist loadfile --no-loadscope-reorder --max-worker-restart=0 \
    --durations=10 --junitxml=build/durations.xml $(1) && tests=good; \
  wait $$lint || { cat build/lint.log >&2; exit 1; }; [ "$$tests" ]
endef

lint: setup ## style, types and format of Python and C++
	@$(IN_VENV) ruff check --quiet .
	@$(IN_VENV) ruff format --check --quiet . || { echo "error: not formatted: make format" >&2; exit 1; }
	@$(IN_VENV) mypy
	@[ -z "$(CPP)" ] || $(IN_VENV) clang-format --dry-run -Werror $(CPP)

test: setup ## lint and all tests but the slow ones
	@$(call tested,-m "$(MARKS)")

verify: setup ## lint and all tests
	@$(call tested,-m "")

wheel: setup ## sdist and wheel of the last commit, installed and used in clean environments
	@.venv/bin/python tools/wheel.py

sanitize: setup ## the programs of tests/cpp under address and undefined-behaviour sanitizers
	@echo 'int main() {}' | $${CXX:-c++} -x c++ -fsanitize=address,undefined -o /dev/null - 2>/dev/null || \
	  { echo "error: $${CXX:-c++} has no sanitizers: install its libasan and libubsan" >&2; exit 1; }
	@$(IN_VENV) cmake -S . -B build/sanitize -G Ninja -DANISOCONTACT_PYTHON=OFF -DANISOCONTACT_CPP_TESTS=ON \
	  -DCMAKE_BUILD_TYPE=Debug -DANISOCONTACT_SANITIZE=address,undefined \
	  -DPython_EXECUTABLE="$(CURDIR)/.venv/bin/python" --log-level=WARNING
	@$(IN_VENV) cmake --build build/sanitize
	@UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 $(IN_VENV) ctest --test-dir build/sanitize --parallel --output-on-failure

clang: setup ## the core and the programs of tests/cpp by clang++, where that is installed
	@command -v clang++ >/dev/null 2>&1 || { echo "skipped: no clang++ on this machine"; exit 0; }; \
	$(IN_VENV) cmake -S . -B build/clang -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DANISOCONTACT_WERROR=ON \
	  -DANISOCONTACT_CPP_TESTS=ON -DPython_EXECUTABLE="$(CURDIR)/.venv/bin/python" --log-level=WARNING && \
	$(IN_VENV) cmake --build build/clang && \
	$(IN_VENV) ctest --test-dir build/clang --parallel --output-on-failure

mutants: setup ## change the core in one place at a time; some test has to notice each
	@$(IN_VENV) python tools/mutants.py

format: setup ## format Python and C++, and write the types of the core anew
	@.venv/bin/python tools/stubs.py
	@$(IN_VENV) ruff check --fix --select I --quiet .
	@$(IN_VENV) ruff format --quiet .
	@[ -z "$(CPP)" ] || $(IN_VENV) clang-format -i $(CPP)

bench: setup ## all benchmarks, this code and others; N="12 24" for other sizes
	@$(IN_VENV) python benchmarks/run.py $(N) --docs

scoreboard: setup ## hard cases with every method and strategy; CASES="pair plate" for some
	@$(IN_VENV) python benchmarks/scoreboard/run.py $(CASES) --docs

docs: setup ## build the documentation in docs/_build/html
	@$(IN_VENV) sphinx-build -W --keep-going -q -b html docs docs/_build/html
	@$(IN_VENV) python tools/dead_links.py docs/_build/html
	@echo "documentation: docs/_build/html/index.html"

clean: ## remove results, built documentation and caches
	rm -rf results docs/_build docs/reference/generated .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +

distclean: clean ## ... and .venv
	rm -rf .venv
