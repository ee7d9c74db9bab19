# Two commands do everything: `make run` and `make test`. Both set up first.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
STUDY ?= studies/boom/study.toml

.PHONY: run test bench format setup coverage mutants dist

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

# Kernels count too: they run interpreted once, so that their lines are seen.
coverage: setup
	NUMBA_DISABLE_JIT=1 $(BIN)/coverage run -m pytest -m "not bench and not compiled"
	$(BIN)/coverage combine
	$(BIN)/coverage report

# Wrong changes that the tests must catch, each in a copy of the tree: some minutes.
# MUTANTS="eq-07 radius" applies those whose names begin so.
mutants: setup
	$(BIN)/python tests/mutants/run.py $(MUTANTS)

# A wheel and an sdist, checked, and the wheel used in an environment of its own.
dist: setup
	rm -rf build dist
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[dist]"
	$(BIN)/python -m build --outdir dist .
	$(BIN)/twine check --strict dist/*
	$(BIN)/check-wheel-contents dist/*.whl
	$(PYTHON) tests/dist/use_wheel.py

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[test]"
	touch $(STAMP)
