# One command sets up and runs the demo, one sets up and tests. Nothing is installed outside of this folder.
#
#   make demo    set up, then run the demo and name its page
#   make test    set up, then run all tests
#   make         set up, then lint, types and tests (what CI runs)

VENV   := .venv
PYTHON := $(VENV)/bin/python
READY  := $(VENV)/.ready

.DEFAULT_GOAL := all
.PHONY: all setup demo test lint types format lock images clean

all: lint types test

setup: $(READY)

$(READY): requirements.lock pyproject.toml tools/find_python.sh
	@found=$$(bash tools/find_python.sh) && \
	{ [ -x $(PYTHON) ] || "$$found" -m venv $(VENV); } && \
	echo "installing into $(VENV) with $$($(PYTHON) --version) (a few minutes the first time)" && \
	$(PYTHON) -m pip install -qq --disable-pip-version-check -r requirements.lock && \
	$(PYTHON) -m pip install -qq --disable-pip-version-check --no-deps --editable . && \
	touch $(READY)

demo: $(READY)
	@$(VENV)/bin/wonderful-team demo

test: $(READY)
	$(PYTHON) -m pytest -n auto --dist worksteal

lint: $(READY)
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .

types: $(READY)
	$(VENV)/bin/mypy

format: $(READY)
	$(VENV)/bin/ruff check --fix .
	$(VENV)/bin/ruff format .

lock: $(READY)
	$(PYTHON) -m pip install -qq --disable-pip-version-check uv
	$(VENV)/bin/uv pip compile --quiet --universal --extra dev --generate-hashes --no-emit-index-url --no-annotate --custom-compile-command "make lock" \
		pyproject.toml -o requirements.lock

images: $(READY)
	$(PYTHON) docs/make_images.py

clean:
	rm -rf $(VENV) .mypy_cache .pytest_cache .ruff_cache .hypothesis build dist
