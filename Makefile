# Dropflow: every habit of the project is one word here, and CI runs the same words (.ci/run).
# A stamp is the file that a step leaves last, so that a second `make setup` does nothing.

PYTHON ?= python3
PORT ?= 8000
DATA ?= data

VENV := .venv
BIN := $(VENV)/bin
REQUIREMENTS := $(VENV)/.requirements-installed
EDITABLE := $(VENV)/.dropflow-installed
COMPILED := $(VENV)/.compiled
NODE_MODULES := frontend/node_modules/.package-lock.json
PAGE := frontend/dist/index.html
PAGE_SOURCES := $(shell find frontend -mindepth 1 \( -name node_modules -o -name dist \) -prune -o -print 2>/dev/null)

# One thread a process: tests and workers run beside each other on few cores.
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 NUMBA_NUM_THREADS=1
EXPORT := $(BIN)/uv export --frozen --no-emit-project --python 3.11 --quiet
# A file's tests stay in one process, so that they share what it has set up.
PYTEST := $(ONE_THREAD) $(BIN)/python -m pytest --numprocesses 2 --dist loadfile
# So that a killed `make` takes the launcher with it; only Linux can.
WITH_ME := $(if $(shell command -v setpriv),setpriv --pdeathsig TERM)

export PORT DATA PIP_DISABLE_PIP_VERSION_CHECK := 1

.SILENT:
.DELETE_ON_ERROR:
.PHONY: help setup python compiled page browser run sign-in test test-full test-page lint types bench bench-detection bench-tracking docs lock clean

help: ## say what can be made
	sed -n 's/^\([a-z-]*\):[^#]*## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 20

setup: python compiled page browser ## install everything, once

run: python page ## start Dropflow here: PORT=8000 DATA=data
	exec $(WITH_ME) $(BIN)/python -m deploy.local

sign-in: python ## another link to sign in with, while Dropflow runs here: PORT=8000 DATA=data
	$(BIN)/python -m deploy.local.sign_in

# The limit ends a run whose process does not end, as a thread left behind by a failing test can make it.
test: setup test-page ## the quick tests (under 15 minutes on 2 cores)
	timeout -k 30 1800 env $(PYTEST) -m "not slow"

test-full: setup test-page ## all tests
	$(PYTEST)

test-page: page
	npm --prefix frontend test --silent

lint: python $(NODE_MODULES) ## style, and who may know whom
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	npm --prefix frontend run lint --silent

types: python $(NODE_MODULES) ## mypy and tsc
	$(BIN)/mypy
	npm --prefix frontend run types --silent

bench: python ## speed, memory and accuracy
	$(BIN)/python -m benchmarks

bench-detection: python ## accuracy and speed of detection beside its peers: IMAGES=folder of real images
	$(ONE_THREAD) $(BIN)/python -m benchmarks.detection $(if $(IMAGES),--data $(IMAGES))

bench-tracking: python ## accuracy and speed of tracking beside trackpy, laptrack and the paper's mode
	$(ONE_THREAD) $(BIN)/python -m benchmarks.tracking

docs: python ## the documentation, into site/
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

lock: ## choose versions that fit together, for Python 3.11 (remove uv.lock first for the newest)
	$(BIN)/python -m pip install --quiet uv
	$(BIN)/uv lock --python 3.11
	$(EXPORT) --output-file requirements.lock
	$(EXPORT) --no-default-groups --group server --group build --output-file deploy/images/requirements.lock

clean: ## remove what was installed and built; DATA stays
	rm -rf $(VENV) frontend/node_modules frontend/dist site

python: $(EDITABLE)

# numba compiles at first use; a first preview would wait for it.
compiled: $(COMPILED)

page: $(PAGE)

browser:
	.ci/browser

$(BIN)/python:
	.ci/venv $(PYTHON) $(VENV)

$(REQUIREMENTS): requirements.lock | $(BIN)/python
	echo "Installing the Python packages (about a minute) ..."
	$(BIN)/python -m pip install --quiet --quiet --no-deps --require-hashes --requirement requirements.lock
	touch $@

$(EDITABLE): pyproject.toml $(REQUIREMENTS)
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	touch $@

$(COMPILED): $(EDITABLE)
	echo "Compiling for this processor (about a minute) ..."
	$(ONE_THREAD) $(BIN)/dropflow compile > /dev/null
	touch $@

$(NODE_MODULES): frontend/package-lock.json frontend/package.json
	command -v npm > /dev/null || { echo "Node 20 or newer with npm is needed to build the page (https://nodejs.org)." >&2; exit 2; }
	echo "Installing the packages of the page ..."
	npm --prefix frontend ci --silent --no-audit --no-fund
	touch $@

$(PAGE): $(PAGE_SOURCES) $(NODE_MODULES)
	echo "Building the page ..."
	npm --prefix frontend run build --silent -- --logLevel error
	touch $@
