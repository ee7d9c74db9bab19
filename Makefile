# Two commands do everything: `make run` and `make test`. Both set up first.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(VENV)/bin/python -m pip install --quiet --disable-pip-version-check
STAMP := $(VENV)/.installed
STUDY ?= studies/boom/study.toml

.PHONY: run studies test test-all bench guard trials fuzz format setup coverage mutants lock lowest dist dist-check docs

run: setup
	$(BIN)/mptune run $(STUDY)

# The paper's study and those that follow it, each as `run` does it, in one table and one figure
# beside what the paper measured: reports/studies.md and .svg.
STUDIES ?= boom boom-2dof boom-estimator boom-adaptive
studies: setup
	$(BIN)/mptune studies $(STUDIES:%=studies/%/study.toml)

test: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	NUMBA_NUM_THREADS=1 $(BIN)/pytest -n 2

# The site, into build/site: the guide, the docstrings, and the examples, which are run for it.
# Strict: a broken link, a missing section of the README or a failing example ends it.
docs: setup
	$(PIP) -c constraints.txt -e ".[docs]"
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build

# All that `test` runs and every example, under each of the interpreters that are there; uv fetches
# more (uv python install 3.13), INTERPRETERS="python3.12" chooses.
INTERPRETERS ?= python3.11 python3.12 python3.13 python3.14
test-all: test
	@for python in $(INTERPRETERS); do \
		$$python -c "" 2>/dev/null || continue; \
		echo "== $$($$python --version)"; \
		place=build/$$($$python -c "import sys; print('venv-%d.%d' % sys.version_info[:2])"); \
		$$python -m venv $$place && \
		$$place/bin/python -m pip install --quiet --disable-pip-version-check -e ".[test]" && \
		NUMBA_NUM_THREADS=1 $$place/bin/python -m pytest -q -n 2 -m "not bench and not fuzz" \
			|| exit 1; \
	done

# The lowest versions that pyproject.toml allows, with kernels of their own. Needs uv, as `lock`.
lowest:
	uv venv --quiet --clear --python 3.11 build/lowest
	VIRTUAL_ENV=build/lowest uv pip install --quiet --only-binary :all: --resolution lowest-direct \
		-r pyproject.toml "pytest>=8" "hypothesis>=6.100"
	VIRTUAL_ENV=build/lowest uv pip install --quiet --no-deps -e .
	build/lowest/bin/python -m pytest -q -o addopts= tests/unit/test_units.py tests/unit/cli/test_stages.py
	NUMBA_CACHE_DIR=build/lowest/kernels build/lowest/bin/python -m mptune.cli warm -v

# Speeds, as ratios to other tools in the same run: reports/bench.md.
bench: setup
	$(BIN)/pytest -m "bench and not trial" -s -p no:randomly tests/bench

# Those of them that hold on a machine that others share, each three times easier.
guard: setup
	MPTUNE_BENCH_SLACK=3 $(BIN)/pytest -m guard -s -p no:randomly tests/bench

# The README's figures anew, and what proofs and memory do at length: hours.
trials: setup
	MPTUNE_BENCH_RUNS=10000 $(BIN)/pytest -m trial -s -p no:randomly tests/bench

# Bad input, extreme studies, full disks, kills and spoilt bytes, by rule and at length: an hour and
# more. MINUTES=10 chooses how long bytes are spoilt at random, KILLS=6 how often a command is killed.
fuzz: setup
	NUMBA_NUM_THREADS=1 $(BIN)/pytest -m fuzz -s -n 0 tests/faults tests/unit/campaign

# Lines that tests run, kernels' too: compiled they would not be seen, and interpreted they are slow.
# So rooms with kernels run interpreted, but for what is marked `compiled`; then those around, and
# those with much beside their kernels, compiled.
KERNELS := certify force identify loops plant robust signals sim systems tune verify
AROUND := certify cli explore identify job loops params report results shape sim verify
coverage: setup
	$(BIN)/coverage erase
	NUMBA_DISABLE_JIT=1 $(BIN)/coverage run -m pytest -q -n 2 tests/paper $(KERNELS:%=tests/unit/%) \
		-m "not compiled and not bench and not fuzz and not examples"
	NUMBA_NUM_THREADS=1 $(BIN)/coverage run -m pytest -q -n 2 tests/browser \
		$(AROUND:%=tests/unit/%) tests/unit/*.py
	$(BIN)/coverage combine --quiet
	$(BIN)/coverage report

# Wrong changes that the tests must catch, each in a copy of the tree: some minutes.
# MUTANTS="eq-07 radius" applies those whose names begin so.
mutants: setup
	$(BIN)/python tests/mutants/run.py $(MUTANTS)

# A wheel and an sdist, checked, and the wheel used in an environment of its own.
dist: dist-check
	$(PYTHON) tests/dist/use_wheel.py

# The quick part of it: both are built and checked, and a command of the unpacked wheel writes a
# study, which needs what the wheel must hold beside its modules.
dist-check: setup
	rm -rf dist build/lib build/bdist.* build/wheel
	$(PIP) -c constraints.txt build check-wheel-contents twine
	$(BIN)/python -m build --no-isolation --outdir dist .
	$(BIN)/twine check --strict dist/*
	$(BIN)/check-wheel-contents dist/*.whl
	$(BIN)/python -m zipfile -e dist/*.whl build/wheel
	cd build/wheel && $(CURDIR)/$(BIN)/python -m mptune.cli new loader
	cd build/wheel && $(CURDIR)/$(BIN)/python -m mptune.cli new lifter --like crane

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# The pinned versions with the hashes of their files, for every system and Python: after a change of
# the dependencies or of constraints.txt. Needs uv (pip install uv); nothing else does.
lock:
	@printf '%s\n' '# The versions of constraints.txt with the hashes of their files, made by `make lock`.' > lock.part
	printf 'setuptools>=77\n' | uv pip compile pyproject.toml - --extra test --universal \
		--python-version 3.11 --constraints constraints.txt --generate-hashes \
		--no-emit-index-url --no-header --no-annotate --quiet >> lock.part
	mv lock.part requirements.lock

setup: $(STAMP)

# What is installed has the hashes of requirements.lock; then the project itself, without looking
# for anything else.
$(STAMP): pyproject.toml requirements.lock
	$(PYTHON) -m venv $(VENV)
	$(PIP) --require-hashes --no-deps -r requirements.lock
	$(PIP) --no-deps --no-build-isolation -e .
	touch $(STAMP)
