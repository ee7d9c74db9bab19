# Two commands do everything: `make run` and `make test`. Both set up first.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
STUDY ?= studies/boom/study.toml

.PHONY: run test bench fuzz format setup coverage mutants

run: setup
	$(BIN)/mptune run $(STUDY)

test: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	NUMBA_NUM_THREADS=1 $(BIN)/pytest -n 2

bench: setup
	$(BIN)/pytest -m bench -s -p no:randomly tests/bench

# Extreme studies and full disks, by rule and at length: half an hour.
fuzz: setup
	NUMBA_NUM_THREADS=1 $(BIN)/pytest -m fuzz -s -n 0 tests/faults

# Kernels count too: they run interpreted once, so that their lines are seen.
coverage: setup
	NUMBA_DISABLE_JIT=1 $(BIN)/coverage run -m pytest -m "not bench and not fuzz and not compiled"
	$(BIN)/coverage combine
	$(BIN)/coverage report

# Wrong changes that the tests must catch, each in a copy of the tree: some minutes.
# MUTANTS="eq-07 radius" applies those whose names begin so.
mutants: setup
	$(BIN)/python tests/mutants/run.py $(MUTANTS)

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[test]"
	touch $(STAMP)
