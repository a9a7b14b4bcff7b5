# One command sets up and runs the demo, one sets up and tests. Nothing is installed outside of this folder.
#
#   make demo    set up, then run the demo and name its page
#   make test    set up, then run all tests
#   make         set up, then lint, types and tests (what CI runs)

VENV   := .venv
PYTHON := $(VENV)/bin/python

.DEFAULT_GOAL := all
.PHONY: all setup demo test lint types format lock images prompts clean

all: lint types test

# Installs exactly what requirements.lock names; says nothing and does nothing when that is there already.
setup:
	@python=$$(bash tools/find_python.sh) && "$$python" tools/install.py $(VENV)

demo: setup
	@$(VENV)/bin/wonderful-team demo

test: setup
	$(PYTHON) -m pytest -n auto --dist worksteal

lint: setup
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .

types: setup
	$(VENV)/bin/mypy

format: setup
	$(VENV)/bin/ruff check --fix .
	$(VENV)/bin/ruff format .

lock: setup
	$(VENV)/bin/uv pip compile --quiet --universal --extra dev --generate-hashes --no-emit-index-url --no-annotate --custom-compile-command "make lock" \
		pyproject.toml -o requirements.lock

images: setup
	$(PYTHON) docs/make_images.py

prompts: setup
	$(PYTHON) docs/make_prompts.py

clean:
	rm -rf $(VENV) .mypy_cache .pytest_cache .ruff_cache .hypothesis build dist
