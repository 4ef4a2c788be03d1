# make run, make test: both make the environment first, in .venv, and are quick from then on.
# Another Python: make test PYTHON=python3.12

NEEDED := import sys; sys.exit(sys.version_info < (3, 10))
PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11 python3.10 python; do \
            $$p -c '$(NEEDED)' 2>/dev/null && { echo $$p; break; }; done)
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
TOOL := PYTHONPATH=tests/support $(BIN)/python tests/tools

.PHONY: help run test bench fuzz soak idle audit samples screenshots equations replays verdict unrelated detector sightings live results clean

help:
	@echo "make run          open the tool on a sample, in the browser (ARGS=--no-browser: only serve it)"
	@echo "make test         check style and types, run every test, browser tests included"
	@echo "make bench        time the stages of a merge"
	@echo "make fuzz         feed every reader of files with damaged ones (ARGS='--seconds 300')"
	@echo "make soak         many tabs for ten minutes: memory, answers, leaks (ARGS='--minutes 2 --waves 4')"
	@echo "make idle         what a server takes that nobody uses (ARGS=--merge: and once a tab has merged)"
	@echo "make audit        ask pip-audit for known holes in what is installed (needs the network)"
	@echo "make samples      simulate the maps in sample_maps again"
	@echo "make screenshots  take the pictures of the README and the guides again"
	@echo "make equations    typeset the equations in static/equations again"
	@echo "make replays      record the pages in static/replays again"
	@echo "make verdict      fit the verdict's model to simulated pairs again (ARGS='--cases DIR'); about an hour"
	@echo "make unrelated    merge 1,000 pairs of unrelated maps without a sighting (ARGS='--pairs 100'); about an hour"
	@echo "make detector     train the detector of robots that ships again; about half an hour"
	@echo "make sightings    look for robots in 2,000 rendered images and scans: found, false, errors; about an hour"
	@echo "make live         merge simulated robots while they drive: right, wrong and unplaced at every moment; 5 minutes"
	@echo "make results      measure the paper's section IV on the samples again: RESULTS.md; about 3 minutes on 2 cores"
	@echo "make clean        remove the environment and everything that was made"

run: $(VENV)/ready
	@$(BIN)/mapmeld serve $(ARGS)

# three processes on two cores: those that wait for a browser or a command leave a core to the third
test: $(VENV)/ready-to-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	@chromium="$$($(BIN)/python tests/support/chromium.py)" && \
	  echo "pytest, with $$chromium" && CHROMIUM="$$chromium" $(BIN)/python -m pytest -n 3 --dist worksteal $(ARGS)

bench: $(VENV)/ready-to-test
	$(BIN)/python -m pytest -o addopts="" -o python_files="bench_*.py" -o python_functions="bench_*" \
	  --benchmark-only --benchmark-columns=min,median,max,rounds tests/bench $(ARGS)

fuzz: $(VENV)/ready-to-test
	@$(PIP) install -e '.[fuzz]'
	@$(TOOL)/fuzz.py $(ARGS)

soak: $(VENV)/ready-to-test
	@$(TOOL)/soak.py $(ARGS)

idle: $(VENV)/ready-to-test
	@$(TOOL)/idle_memory.py $(ARGS)

# pip-audit in an environment of its own: what it brings is none of ours. --strict, or packages whose
# state it cannot learn, all of them without a network, count as sound.
audit: $(VENV)/ready
	@test -x $(VENV)/audit/bin/python || $(BIN)/python -m venv $(VENV)/audit
	@$(VENV)/audit/bin/python -m pip --disable-pip-version-check --quiet install pip-audit
	@$(PIP) freeze --exclude-editable > $(VENV)/audit/versions.txt
	@$(VENV)/audit/bin/pip-audit --strict --no-deps --disable-pip -r $(VENV)/audit/versions.txt $(ARGS) || { \
	  echo "make audit: not clean. Either holes are named above, or pip-audit could not learn about a package"; \
	  echo "(without a network: about any), and then this says nothing of it, good or bad."; exit 1; }

samples: $(VENV)/ready
	$(BIN)/mapmeld samples sample_maps

screenshots: $(VENV)/ready-to-test
	@chromium="$$($(BIN)/python tests/support/chromium.py)" && \
	  CHROMIUM="$$chromium" $(TOOL)/screenshots.py $(or $(ARGS),static/screenshots shown)

equations: $(VENV)/ready
	@$(PIP) install -e '.[equations]'
	@$(TOOL)/equations.py

replays: $(VENV)/ready
	@for name in $(or $(ARGS),office_r2_r1 bent_r2_r1); do \
	  $(BIN)/mapmeld replay $$name --out static/replays/$$name.html || exit; done

detector: $(VENV)/ready
	@$(TOOL)/detector_training.py $(ARGS)

sightings: $(VENV)/ready
	@$(TOOL)/sighting_errors.py $(ARGS)

verdict: $(VENV)/ready
	@$(TOOL)/verdict_training.py $(ARGS)

unrelated: $(VENV)/ready
	@$(TOOL)/unrelated_pairs.py $(ARGS)

live: $(VENV)/ready
	@$(TOOL)/live_drives.py $(ARGS)

results: $(VENV)/ready
	@$(PIP) install -e '.[surf]'
	@$(TOOL)/results.py

clean:
	rm -rf $(VENV) build dist out *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis .benchmarks
	find mapmeld algorithms app tests -name __pycache__ -prune -exec rm -rf {} +

# An environment whose Python has gone, or that was never finished, is made anew.
ifneq ($(shell $(BIN)/python -c 'print("starts")' 2>/dev/null),starts)
.PHONY: $(VENV)/made
endif

$(VENV)/made:
	@test -n "$(PYTHON)" || { \
	  echo "mapmeld needs Python 3.10 or newer, and none was found. Install one, or name it:"; \
	  echo "  make PYTHON=/path/to/python3"; exit 1; }
	@$(PYTHON) -c '$(NEEDED)' || { \
	  echo "mapmeld needs Python 3.10 or newer; $(PYTHON) is not. Name another: make PYTHON=python3.12"; \
	  exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { \
	  echo "$(PYTHON) lacks the modules venv and pip. On Debian and Ubuntu: apt install python3-venv"; \
	  exit 1; }
	@echo "making $(VENV) with $$($(PYTHON) --version)"
	@$(PYTHON) -m venv --clear $(VENV)
	@touch $@

$(VENV)/ready: $(VENV)/made pyproject.toml
	@echo "installing mapmeld into $(VENV): minutes the first time, seconds from then on"
	@$(PIP) install -e .
	@touch $@

$(VENV)/ready-to-test: $(VENV)/ready
	@echo "installing what the tests need"
	@$(PIP) install -e '.[test]'
	@touch $@
