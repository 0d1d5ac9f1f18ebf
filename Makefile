# Thin: each target creates .venv when it is missing and uses it after.
PYTHON ?= python3
# Each release of ROS 2 that has wheels gets an environment of its own: `make live ROS=kilted`.
ROS ?= jazzy
RELEASE := $(addprefix -,$(filter-out jazzy,$(ROS)))
ENVIRONMENT := .venv$(RELEASE)
BIN := $(ENVIRONMENT)/bin
READY := $(ENVIRONMENT)/.ready

.PHONY: help demo quick test test-all test-beside test-random coverage live live-each lint format bench docs fuzz emf reference \
	types constraints held audit sbom release-check fresh faults soak stories experiment mutate proofs studio studio-check wheel clean

help:  ## show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "%-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

$(READY): pyproject.toml
	@echo "Making $(ENVIRONMENT) with what jausml, its example and its tests need: about 270 MB are fetched, once."
	test -x $(BIN)/python || $(PYTHON) -m venv $(ENVIRONMENT)
	$(BIN)/python -m pip install --quiet --editable ".[ros$(RELEASE),demo,editor,dev]"
	# What pip builds from; left here it would hide the installed entry points from `python -m`.
	rm -rf jausml.egg-info
	touch $@

demo: $(READY)  ## generate the example system, drive it through a turn, and draw the result
	$(BIN)/python models/catvehicle/demo.py

quick: $(READY)  ## run ruff, and in 15 seconds the tests that guard a change since main
	$(BIN)/python tools/quick.py

# Many tests wait for processes, so there are more workers than processors (tests/conftest.py).
# TESTS=tests/runtime runs a part. Tests that fail in the crowd are run again, alone.
test: $(READY)  ## run the tests that guard everything, in six minutes
	$(BIN)/python tools/suite.py -m "not slow" $(TESTS)

# The budget of tests is judged by a whole run only; JUDGED is what CI adds, the skips that it expects.
test-all: $(READY)  ## run these, those that go further, and what uses rclpy on Kilted, in seventeen minutes
	$(BIN)/python tools/suite.py $(JUDGED) $(if $(TESTS),$(TESTS),--judge-budget)
	$(MAKE) live ROS=kilted TESTS='-m "live and not slow" $(if $(TESTS),$(TESTS),tests/live)'

test-beside: $(READY)  ## run what compares with definitions of others, in a folder `shared` beside the checkout
	$(BIN)/python tools/suite.py -m beside $(JUDGED) $(TESTS)

test-random: export JAUSML_EXAMPLES ?= 200
test-random: export PYTEST_ADDOPTS ?= --timeout=1200
test-random: $(READY)  ## run both, with 200 random examples for each property
	$(BIN)/python tools/suite.py $(TESTS)

coverage: $(READY)  ## run all tests and show untested lines; fail below the agreed share
	$(BIN)/python tools/build_studio.py --if-stale
	$(BIN)/python -m pytest -n auto --dist worksteal --cov --cov-report=term:skip-covered \
	  $(if $(TESTS),--cov-fail-under=0) $(TESTS)

live: $(READY)  ## run the tests that depend on the release of ROS: what uses rclpy
	$(BIN)/python tools/suite.py -m live $(TESTS)

live-each:  ## run these tests on Jazzy and on Kilted, each in an environment of its own
	$(MAKE) live ROS=jazzy
	$(MAKE) live ROS=kilted

lint: $(READY)  ## check format, style, types and layers
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(READY)  ## format the code, and fix what can be fixed automatically
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# ONLY="latency load" measures a part; BENCH=--quick looks for a few minutes.
bench: $(READY)  ## measure everything in about twelve minutes, and write build/results/performance.md
	$(BIN)/python benchmarks/run.py $(BENCH) $(if $(ONLY),--only $(ONLY))

faults: $(READY)  ## provoke every fault with real processes in about twelve minutes, and write build/results/faults.md
	JAUSML_FAULTS=build/results/faults.json $(BIN)/python -m pytest -p no:xdist --durations=10 tests/faults
	$(BIN)/python benchmarks/fault_page.py build/results/faults.json

stories: $(READY) wheel  ## tell the stories of three new users, from an empty folder with the wheel, in both notations
	installed=$$(mktemp -d) && trap 'rm -rf "$$installed"' EXIT && $(PYTHON) -m venv "$$installed" \
	  && "$$installed/bin/python" -m pip install --quiet "$$(echo wheels/jausml-*.whl)[ros]" pytest \
	  && JAUSML_STORIES="$$installed/bin" $(BIN)/python -m pytest -p no:xdist --durations=0 tests/live/test_stories.py

studio: $(READY)  ## build the pages of `jausml studio` and `jausml operate` with npm; node comes from PyPI if it is missing
	$(BIN)/python tools/build_studio.py --no-check

studio-check: $(READY)  ## build the page of the studio, and run its linter, type checker and tests
	$(BIN)/python tools/build_studio.py

# What an earlier build left would be packed too.
wheel:  ## build a wheel with the page of the studio in wheels/, within a minute
	test -x $(BIN)/python || $(PYTHON) -m venv $(ENVIRONMENT)
	$(BIN)/python tools/build_studio.py --no-check
	rm -rf build/lib build/bdist.* wheels/jausml-*.whl
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir wheels .
	rm -rf build/lib build/bdist.* jausml.egg-info

MINUTES ?= 60

soak: $(READY)  ## send messages both ways through one bridge for MINUTES, and check that nothing grows or gets lost unseen
	$(BIN)/python benchmarks/soak.py --minutes $(MINUTES)

experiment: $(READY)  ## compare the right turn by JAUS alone and through the bridge in about five minutes, and write experiment-out/full/experiment.md
	$(BIN)/python -m experiments.right_turn $(EXPERIMENT)

mutate: $(READY)  ## break the models of the examples in about a quarter of an hour, and write build/results/mutations.md
	$(BIN)/python tools/build_mutations.py $(MUTATE)

proofs: $(READY)  ## prove the ready maps in about ten minutes, and write build/results/proofs.md
	$(BIN)/python tools/build_proofs.py $(PROOFS)

docs: $(READY)  ## build the site of the documentation in site/VERSION/; fail at a warning
	$(BIN)/python tools/build_site.py

SECONDS ?= 60

fuzz: $(READY)  ## run every fuzz target for SECONDS, guided by coverage if atheris is installed
	@for target in $(notdir $(basename $(wildcard tests/fuzz/targets/[a-z]*.py))); do \
	  echo "$$target:"; $(BIN)/python tests/fuzz/run.py $$target --seconds $(SECONDS) || exit 1; \
	done

emf: $(READY)  ## check metamodels and models with the real Eclipse EMF, and record its verdicts
	$(BIN)/python tools/record_emf.py

reference: $(READY)  ## write the references into docs/reference/, for reading here; the site has them by itself
	$(BIN)/python tools/build_reference.py

types: $(READY)  ## write what follows from metamodels and conversions: type stubs, and names for editors
	$(BIN)/python tools/build_model_types.py
	$(BIN)/python tools/build_grammar.py

# Python 3.10 and all later ones, on any system; no index is named.
COMPILE = $(BIN)/uv pip compile --quiet --universal --python-version 3.10 --generate-hashes --upgrade \
	--no-header --no-annotate --no-emit-index-url --no-emit-find-links pyproject.toml

constraints: $(READY)  ## hold what CI, releases and the image install to versions with hashes, in requirements/
	$(BIN)/python -m pip install --quiet "uv>=0.5"
	$(COMPILE) --extra ros --extra demo --extra editor --extra dev --output-file requirements/ci.txt
	$(COMPILE) --extra diagram --output-file requirements/image.txt
	$(COMPILE) --extra release --output-file requirements/release.txt

held:  ## make the environment with these versions, as CI does
	$(PYTHON) -m venv $(ENVIRONMENT)
	$(BIN)/python -m pip install --quiet --require-hashes --requirement requirements/ci.txt
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	rm -rf jausml.egg-info
	touch $(READY)

RELEASING := build/releasing

$(RELEASING): requirements/release.txt
	$(PYTHON) -m venv $@
	$@/bin/python -m pip install --quiet --require-hashes --requirement $<
	touch $@

audit: $(RELEASING)  ## ask whether there are known weaknesses in what CI, releases and the image install
	for each in ci image release; do \
	  $</bin/pip-audit --disable-pip --requirement requirements/$$each.txt || exit 1; done

sbom: $(READY) $(RELEASING)  ## build sdist and wheel in dist/, and write there what they install (CycloneDX)
	rm -rf dist
	$(BIN)/python tools/build_studio.py --no-check
	$(RELEASING)/bin/python -m build --outdir dist .
	$(RELEASING)/bin/cyclonedx-py requirements --pyproject pyproject.toml --output-reproducible \
	  --output-file dist/sbom.cdx.json requirements/image.txt

release-check: $(READY)  ## check version, changelog, wheel, sdist and the lowest dependency versions
	$(BIN)/python tools/release_check.py

# FRESH="--systems trixie --only demo" runs a part; it needs root and debootstrap.
fresh: $(READY)  ## run `make demo` and `make test` on bare systems of Debian, and print a table
	$(BIN)/python tools/fresh.py $(FRESH)

clean:  ## remove everything that make has made
	rm -rf .venv build dist wheels *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis site demo-out experiment-out jausml/authoring/studio/page jausml/live/operating/page studio/node_modules
	rm -f $$(sed -n 's|^/\(docs/reference/\)|\1|p' .gitignore)
