# `make` lists what can be done. Everything happens in .venv, which the first command sets up.
# Another interpreter: make PYTHON=/path/to/python3.11 setup

# For 3.11 there is a wheel of PyBullet, so it comes first, be it one that uv has or fetches.
PYTHON ?= $(shell fits() { "$$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' && echo "$$1"; }; \
	{ fits python3.11 || fits "$$(uv python find 3.11)" || { uv python install 3.11 && fits "$$(uv python find 3.11)"; } \
	|| fits python3 || fits python; } 2>/dev/null)
# For test-newest.
NEWEST ?= $(shell for python in python3.14 python3.13 python3.12; do \
	$$python -c '' 2>/dev/null && { echo $$python; break; }; done)

BIN := .venv/bin
INSTALLED := .venv/.installed
INSTALLED_LINT := .venv/.installed-lint
INSTALLED_DEV := .venv/.installed-dev
PINS := pyproject.toml constraints.txt
# In a clone these are there; an archive of the sources may have come without links, which checkers and editors need.
LINKS := $(addprefix remqa_data/,agents configs evaluation generators templates)

SCENES ?= 120
# A folder for each number of rooms, so that one does not stand in the way of another.
DATASET := out/remqa$(if $(filter-out 120,$(SCENES)),-$(SCENES))

# Rooms that networks learn from beside that dataset's own. Those that answer learn from as many others, too, and those that find
# in two stages what an expression means from as many again.
MORE_SCENES ?= 100
SAMPLED := out/sampled-$(MORE_SCENES)
ONCE := --data $(DATASET) --more $(SAMPLED)
TWICE := $(ONCE) --more $(SAMPLED)-1
THRICE := $(TWICE) --more $(SAMPLED)-2

# All that come with the package; the others are built upon the first ones.
FIRST := detector view_encoder refiner
NETWORKS := $(FIRST) $(filter-out $(FIRST),$(basename $(notdir $(wildcard configs/agents/training/*.yaml))))
TWO_STAGE := language_attention_two_stage anchored_matcher plain_matcher
# Those that have learnt from that dataset's own rooms alone.
ALONE := a3c scene_priors savn eqa bc_transformer mcn cgan
ANSWERERS := $(filter answerer%,$(NETWORKS))
SYSTEMS := random semantic_map framework framework_two_stage framework_anchored framework_committee framework_memory predicted_map frontier a3c scene_priors savn eqa iqa bc_transformer

# They find what an expression means, some of them together.
COMMITTEES := three_matchers
REFERRING := language_attention $(TWO_STAGE) $(COMMITTEES) mcn cgan

# What walkers of the paper learn depends much on the draws; these are trained and played with other seeds than 0, too.
SEEDED := a3c savn scene_priors eqa iqa
SEEDS := 1 2

.DEFAULT_GOAL := help
.PHONY: help setup dataset agents test test-fast test-newest lint format build docs bench clean

help:  ## list the targets
	@awk -F ':.*##  *' '/^[a-z-]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

setup: $(INSTALLED_DEV)  ## make .venv and install the package with its development tools

dataset: $(INSTALLED)  ## the main job: the whole benchmark, in out/remqa; `make dataset SCENES=12` for less, in out/remqa-12
	$(BIN)/remqa-gen --scenes $(SCENES) --out $(DATASET) --resume

agents: $(INSTALLED_DEV)  ## train the paper's networks on that dataset, let all systems play, and make their tables, in out/agents
	$(BIN)/remqa-gen --layouts sampled --scenes $(MORE_SCENES) --out $(SAMPLED) --resume
	for seed in 1 2; do \
		$(BIN)/remqa-gen --layouts sampled --scenes $(MORE_SCENES) --seed $$seed --out $(SAMPLED)-$$seed --resume || exit; \
	done
	$(BIN)/remqa-agent train $(FIRST) $(ONCE) --resume
	$(BIN)/remqa-data cache $(DATASET) --split train --configurations 0 --features remqa_data.agents.view_features:features
	$(BIN)/remqa-agent train $(ALONE) --data $(DATASET) --resume
	$(BIN)/remqa-agent train $(filter-out $(FIRST) $(ALONE) $(ANSWERERS) $(TWO_STAGE),$(NETWORKS)) $(ONCE) --resume
	$(BIN)/remqa-agent train $(ANSWERERS) $(TWICE) --resume
	$(BIN)/remqa-agent train $(TWO_STAGE) $(THRICE) --resume
	$(BIN)/remqa-agent predict detector refiner $(REFERRING) --data $(DATASET) --split val --weights out/weights
	$(BIN)/remqa-agent predict $(NETWORKS) $(COMMITTEES) --data $(DATASET) --weights out/weights
	$(BIN)/remqa-agent run $(SYSTEMS) --data $(DATASET) --weights out/weights --resume
	for seed in $(SEEDS); do \
		$(BIN)/remqa-agent train $(SEEDED) --data $(DATASET) --seed $$seed --resume || exit; \
	done
	$(BIN)/remqa-agent run $(SEEDED) $(SEEDS:%=--seed %) --data $(DATASET) --weights out/weights --resume
	$(BIN)/remqa-agent run $(SEEDED) $(SEEDS:%=--seed %) --data $(DATASET) --weights out/weights --seen 240 --resume
	$(BIN)/remqa-agent predict $(REFERRING) --data $(DATASET) --split train --weights out/weights
	$(BIN)/remqa-agent run $(SYSTEMS) --data $(DATASET) --weights out/weights --seen 240 --resume
	$(BIN)/remqa-agent curves --weights out/weights
	$(BIN)/remqa-agent table --data $(DATASET) --weights out/weights

# Modules are compiled once, and not by each of the many processes that tests start, whatever the environment asks for.
test test-fast test-newest: export PYTHONDONTWRITEBYTECODE =

test: $(INSTALLED_DEV) lint  ## lint, then all tests on two cores
	$(BIN)/python -m pytest -n 2 --dist worksteal

test-fast: $(INSTALLED_DEV)  ## only the tests that take less than half a second
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow"

test-newest: .venv-newest/bin/python  ## test-fast with the newest version of everything, on NEWEST=python3.13 or so
	$< -m pip install --quiet --upgrade --upgrade-strategy eager --editable '.[dev]'
	$(call without_screen,$<)
	$< -m pytest -n 2 --dist worksteal -m "not slow"

lint: $(INSTALLED_LINT)  ## ruff, the format, and mypy --strict on the library; installs neither torch nor ray
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(INSTALLED_LINT)  ## let ruff sort imports and lay the code out
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

build: $(INSTALLED_DEV)  ## the sdist and the wheel, in dist/
	$(BIN)/python -c "from setuptools import build_meta; build_meta.build_sdist('dist'); build_meta.build_wheel('dist')"

docs: $(INSTALLED_DEV)  ## the documentation as a site, in site/
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet

bench: $(INSTALLED_DEV)  ## measure speed, with the dataset in out/remqa if there is one
	$(BIN)/python benchmarks/run.py $(patsubst %/manifest.json,%,$(wildcard $(DATASET)/manifest.json))

clean:  ## remove .venv, caches and build files (out/ stays)
	rm -rf .venv .venv-newest build dist site *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# Installed again when a pin changes, so that `git pull && make test` is enough.
$(INSTALLED): $(PINS) | $(BIN)/python $(LINKS)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable .
	@touch $@

$(INSTALLED_LINT): $(PINS) | $(BIN)/python $(LINKS)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[lint]'
	@touch $(INSTALLED) $@

$(INSTALLED_DEV): $(PINS) | $(BIN)/python $(LINKS)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	$(call without_screen,$(BIN)/python,--constraint constraints.txt)
	@touch $(INSTALLED) $(INSTALLED_LINT) $@

$(LINKS):
	ln -s ../$(notdir $@) $@

# ai2thor brings the OpenCV that opens windows and needs libGL; the one without takes its place again.
define without_screen
$(1) -m pip uninstall --quiet --yes opencv-python
$(1) -m pip install --quiet $(2) --force-reinstall --no-deps opencv-python-headless
endef

$(BIN)/python:
	@test -n "$(PYTHON)" || { echo "No Python 3.11 or newer found. Install Python 3.11," \
		"or name it: make PYTHON=/path/to/python3.11" >&2; exit 1; }
	@$(PYTHON) tools/check_python.py
	$(PYTHON) -m venv .venv

.venv-newest/bin/python:
	@test -n "$(NEWEST)" || { echo "No Python 3.12 or newer found. Name one: make NEWEST=/path/to/python3.13" \
		"test-newest" >&2; exit 1; }
	@$(NEWEST) tools/check_python.py
	$(NEWEST) -m venv .venv-newest
