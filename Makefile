# Everything a newcomer needs, with nothing but Python 3.11+ and make. The environment is made once and
# again only when pyproject.toml or constraints.txt changes.

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
JOBS   ?= 2

.DEFAULT_GOAL := help
.PHONY: help demo test test-fast lint bench constraints clean

help:
	@echo 'make demo       the four-team factory with a carrier that breaks'
	@echo 'make test       all tests'
	@echo 'make test-fast  the tests that need no whole systems, in a minute or so'
	@echo 'make lint       ruff, mypy, import-linter'
	@echo 'make bench      the figures of docs/performance.md'

$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit("muster needs Python 3.11 or later; this is " + sys.version.split()[0] + ". Say: make PYTHON=python3.11" if sys.version_info < (3, 11) else 0)'
	@test -x $(BIN)/pip || $(PYTHON) -m venv $(VENV) || { echo 'No virtual environment could be made; on Debian and Ubuntu: apt install python3-venv' >&2; exit 1; }
	$(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev]'
	@touch $@

demo: $(STAMP)
	$(BIN)/muster run factory/broken_carrier --clock realtime:4

test: $(STAMP)
	$(BIN)/pytest -n $(JOBS)

test-fast: $(STAMP)
	$(BIN)/pytest -n $(JOBS) -m 'not slow'

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(STAMP)
	@for file in $$(grep -l '^def run(' bench/*.py); do \
	  name=$$(basename $$file .py); echo "== $$name"; $(BIN)/muster bench $$name || exit 1; done

# The full pin of every package that a fresh environment gets; run it after a change of the dependencies.
constraints:
	rm -rf $(VENV)-pin && $(PYTHON) -m venv $(VENV)-pin
	$(VENV)-pin/bin/pip install --quiet --disable-pip-version-check '.[dev]'
	{ echo '# Every package of a fresh environment, pinned; made by: make constraints'; \
	  $(VENV)-pin/bin/pip freeze --exclude muster; } > constraints.txt
	rm -rf $(VENV)-pin

clean:
	rm -rf $(VENV) $(VENV)-pin .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache dist
