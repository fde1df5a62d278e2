# One virtual environment, made once and kept up to date with pyproject.toml.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/ready

.PHONY: help demo serve test lint bench docs figures sample clean

help:
	@echo "make demo    run the whole method on the sample building"
	@echo "make serve   follow phones live, in a browser"
	@echo "make test    run the tests"
	@echo "make lint    ruff, mypy, import-linter"
	@echo "make bench   measure speed and memory"
	@echo "make docs    build the documentation into site/"
	@echo "make figures draw the documentation's figures anew"
	@echo "make sample  make the sample building anew"
	@echo "make clean   remove the virtual environment and what was built"

$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "PALMS needs Python 3.11 or newer; set PYTHON=/path/to/python3.11"; exit 1; }
	@echo "setting up $(VENV) (once)"
	@$(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --editable '.[dev]'
	@touch $@

demo: $(READY)
	@$(BIN)/palms demo

serve: $(READY)
	@$(BIN)/palms serve

test: $(READY)
	@$(BIN)/python -m pytest --numprocesses auto --dist worksteal

lint: $(READY)
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(READY)
	@$(BIN)/python -m benchmarks --json results/speed.json --results docs/results.md --figures docs/figures

$(VENV)/docs-ready: $(READY)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@

docs: $(VENV)/docs-ready
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	@echo "site/index.html"

figures: $(READY)
	@$(BIN)/python tools/make_figures.py

sample: $(READY)
	@$(BIN)/python tools/make_sample.py

clean:
	rm -rf $(VENV) site build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
