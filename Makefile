# Two commands do all the set-up: `make demo` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
VLM := .venv-vlm
# The other supported versions of Python that this machine has.
PYTHONS := $(foreach version,3.12 3.13,$(shell python$(version) -c 'print("python$(version)")' 2>/dev/null))

# Pages that hold what the program says: README's tables, help of commands, the configuration.
WRITTEN := README.md $(wildcard docs/commands/*.md docs/reference/*.md)

# Where an image forbids bytecode, every process of every test would compile all modules again.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo test slow freeze mutants test-vlm lint docs results results-check pages wheel format clean

demo: $(VENV)/.installed  ## search for a bed in the built-in house
	$(BIN)/hypernav find bed --seed 2 --out runs/demo

test: $(VENV)/.installed-dev  ## the tests, in a few minutes
	$(BIN)/pytest -n auto --dist worksteal -m "not slow and not freeze" --timeout 300

slow: $(VENV)/.installed-dev  ## the longer checks
	$(BIN)/pytest -n auto --dist worksteal -m slow --timeout 600

freeze: $(VENV)/.installed-dev  ## every building and episode of the frozen splits, made anew; 40 minutes of one core
	rm -rf build/freeze
	HYPERNAV_CACHE=$(abspath build/freeze) $(BIN)/pytest -n auto -m freeze --timeout 3600
	rm -rf build/freeze

mutants: $(VENV)/.installed-dev  ## half an hour of small faults in what the robot runs: which do the tests miss?
	$(BIN)/python -m pip install --quiet --group mutants
	$(BIN)/python scripts/mutants.py

test-vlm: $(VLM)/.installed  ## the tests with real, tiny networks and llama.cpp's server, and of the GPU renderer; installs the CPU build of torch
	$(VLM)/bin/pytest tests/local_vlm tests/real_servers tests/simulator/worlds/drawing/test_warp_renderer.py --timeout 600

lint: $(VENV)/.installed-dev $(VENV)/.installed-docs  ## style, spelling, types, and who may import whom
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/codespell docs examples scripts src *.md
	$(BIN)/pyright
	PATH=$(abspath $(BIN)):$$PATH $(BIN)/python scripts/public_types.py
	$(BIN)/lint-imports
	$(BIN)/python scripts/write_pages.py --check $(WRITTEN)

docs: $(VENV)/.installed-docs  ## run what the pages say, and build the site
	$(BIN)/python scripts/run_pages.py README.md CONTRIBUTING.md docs/*.md docs/*/*.md \
	  examples/notebooks/*.ipynb
	$(BIN)/mkdocs build --strict

results: $(VENV)/.installed-dev  ## measure a table of the docs anew: make results TABLE=exploring; hours
	$(BIN)/python scripts/measure_results.py $(TABLE)
	$(BIN)/python scripts/write_pages.py $(WRITTEN)

results-check: $(VENV)/.installed-dev  ## some of the searches of the tables that have a check (or of TABLE): do they still hold?
	$(BIN)/python scripts/measure_results.py --check $(TABLE)

pages: $(VENV)/.installed-dev  ## write help, configuration and tables into the pages that show them
	$(BIN)/python scripts/write_pages.py $(WRITTEN)

wheel: $(BIN)/python  ## build wheel and sdist, and search with the wheel alone, on every Python and with the lowest dependencies
	rm -rf dist build/wheel
	$(PYTHON) -m venv build/wheel/tools
	build/wheel/tools/bin/pip install --quiet build twine uv
	build/wheel/tools/bin/python -m build
	build/wheel/tools/bin/twine check --strict dist/*
	cd build/wheel && for trial in $(PYTHON)/highest $(PYTHON)/lowest-direct $(PYTHONS:%=%/highest); do \
	  resolution=$${trial##*/} python=$${trial%/*}; empty=$$(basename $$python)-$$resolution; \
	  echo "the wheel alone: $$empty" && $$python -m venv $$empty && \
	  tools/bin/uv pip install --quiet --python $$empty --resolution $$resolution ../../dist/*.whl && \
	  $$empty/bin/hypernav --version && $$empty/bin/hypernav find bed --seed 2 --out $$empty/page && \
	  cmp $$empty/page/trace.jsonl $(notdir $(PYTHON))-highest/page/trace.jsonl || exit 1; \
	done
	for version in 3.11 3.12 3.13; do \
	  build/wheel/tools/bin/uv pip compile --quiet --python-version $$version --only-binary :all: \
	    --all-extras pyproject.toml >/dev/null || exit 1; \
	done

format: $(VENV)/.installed-dev
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "hypernav needs Python 3.11 or newer; say which one: make demo PYTHON=python3.12"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip

$(VENV)/.installed: $(BIN)/python pyproject.toml
	$(BIN)/python -m pip install --quiet --editable .
	touch $@

$(VENV)/.installed-dev: $(BIN)/python pyproject.toml
	$(BIN)/python -m pip install --quiet --editable '.[bags,ros2,onnx,hm3d,ifc,robot,foxglove,rerun]' --group dev
	touch $@

$(VENV)/.installed-docs: $(BIN)/python pyproject.toml
	$(BIN)/python -m pip install --quiet --editable '.[notebook,robot]' --group docs
	touch $@

# The torchvision of the package index wants CUDA's torch; only its Python parts are used.
$(VLM)/.installed: pyproject.toml
	$(PYTHON) -m venv $(VLM)
	$(VLM)/bin/python -m pip install --quiet --upgrade pip
	$(VLM)/bin/python -m pip install --quiet torch==2.13.0
	$(VLM)/bin/python -m pip install --quiet transformers==5.23.0 accelerate openai
	$(VLM)/bin/python -m pip install --quiet xllamacpp==2026.10.11549 gguf==0.19.0
	$(VLM)/bin/python -m pip install --quiet --no-deps torchvision==0.28.0
	$(VLM)/bin/python -m pip install --quiet --editable '.[bags,ros2,onnx,hm3d,ifc,robot,foxglove,rerun,gpu]' --group dev
	touch $@

clean:
	rm -rf $(VENV) $(VLM) .pytest_cache .ruff_cache .hypothesis
