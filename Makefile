# `make` lists what can be done. Everything happens in .venv, which the first command sets up.
# Another interpreter: make PYTHON=/path/to/python3.11 setup

PYTHON ?= $(shell for python in python3.11 python3 python; do \
	$$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo $$python; break; }; done)

BIN := .venv/bin
INSTALLED := .venv/.installed
INSTALLED_DEV := .venv/.installed-dev
PINS := pyproject.toml constraints.txt

SCENES ?= 120
DATASET := out/remqa

.DEFAULT_GOAL := help
.PHONY: help setup dataset test test-fast lint bench clean

help:  ## list the targets
	@awk -F ':.*##  *' '/^[a-z-]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

setup: $(INSTALLED_DEV)  ## make .venv and install the package with its development tools

dataset: $(INSTALLED)  ## the main job: the whole benchmark, in out/remqa; `make dataset SCENES=12` for less
	$(BIN)/remqa-gen --scenes $(SCENES) --out $(DATASET) --resume

test: lint  ## lint, then all tests on two cores
	$(BIN)/python -m pytest -n 2

test-fast: $(INSTALLED_DEV)  ## only the tests that take seconds
	$(BIN)/python -m pytest -n 2 -m "not slow"

lint: $(INSTALLED_DEV)  ## ruff, the format, and mypy --strict on the library
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench: $(INSTALLED_DEV)  ## measure speed, with the dataset in out/remqa if there is one
	$(BIN)/python benchmarks/run.py $(patsubst %/manifest.json,%,$(wildcard $(DATASET)/manifest.json))

clean:  ## remove .venv, caches and build files (out/ stays)
	rm -rf .venv build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# Installed again when a pin changes, so that `git pull && make test` is enough.
$(INSTALLED): $(PINS) | $(BIN)/python
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable .
	@touch $@

$(INSTALLED_DEV): $(PINS) | $(BIN)/python
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	@# ai2thor brings the OpenCV that opens windows and needs libGL; the one without takes its place again.
	$(BIN)/python -m pip uninstall --quiet --yes opencv-python
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --force-reinstall --no-deps opencv-python-headless
	@touch $(INSTALLED) $@

$(BIN)/python:
	@test -n "$(PYTHON)" || { echo "No Python 3.11 or newer found. Install Python 3.11," \
		"or name it: make PYTHON=/path/to/python3.11 setup" >&2; exit 1; }
	@$(PYTHON) -m venv .venv || { rm -rf .venv; echo "$(PYTHON) cannot make a virtual environment." \
		"On Debian and Ubuntu: apt install python3.11-venv" >&2; exit 1; }
