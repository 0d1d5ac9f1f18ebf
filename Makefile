# Thin: each target creates .venv when it is missing and uses it after.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready

.PHONY: demo test coverage live lint format bench fuzz emf reference types clean

$(READY): pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --editable ".[ros,demo,editor,dev]"
	touch $@

demo: $(READY)  ## generate the example system, drive it through a turn, draw the result
	$(BIN)/python models/catvehicle/demo.py

# What binds ports runs by itself, the rest two at a time. Nothing chosen (5) is no failure.
test: $(READY)  ## every test
	$(BIN)/python -m pytest --durations=15 -m "not alone" -n 2 --dist loadfile $(TESTS) || test $$? -eq 5
	$(BIN)/python -m pytest --durations=15 -m alone $(TESTS) || test $$? -eq 5

coverage: $(READY)  ## every test, and which lines none of them runs
	$(BIN)/python -m pytest --cov --cov-report=term:skip-covered $(TESTS)

live: $(READY)  ## the tests with real processes: rclpy, sockets, tshark
	@command -v tshark >/dev/null || echo "tshark is absent: the Wireshark dissector is NOT tested (apt-get install tshark)"
	$(BIN)/python -m pytest -m live $(TESTS)

lint: $(READY)  ## format, lint, types, layers
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(READY)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench: $(READY)  ## the figures that docs/performance.md quotes
	$(BIN)/python benchmarks/run.py

SECONDS ?= 60

fuzz: $(READY)  ## every fuzz target for SECONDS each, guided by coverage where atheris is installed
	@for target in $(notdir $(basename $(wildcard fuzz/targets/[a-z]*.py))); do \
	  echo "$$target:"; $(BIN)/python fuzz/run.py $$target --seconds $(SECONDS) || exit 1; \
	done

emf: $(READY)  ## judge metamodels and models with the real Eclipse EMF and record its verdicts
	$(BIN)/python tools/record_emf.py

reference: $(READY)  ## write docs/reference/ anew
	$(BIN)/python tools/build_reference.py

types: $(READY)  ## write the stubs of the metamodels' classes anew
	$(BIN)/python tools/build_model_types.py

clean:
	rm -rf .venv build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis demo-out
