# Two commands for a user: `make demo` and `make test`. Each does all of its own set-up.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
PAGE   := src/seacrane/server/page/index.html
WEB    := $(shell find web -path web/node_modules -prune -o -type f -print 2>/dev/null)
ARGS   ?=
CHART  := web/core/design/loadChart
BY_THE_CLOCK := tests/contract tests/e2e tests/unit/server tests/unit/cosim/test_cosim_faults.py tests/unit/cosim/test_cosim_pacing.py

.PHONY: demo test foreign-platforms check setup browser load-chart docs format clean
.DELETE_ON_ERROR:

setup: $(VENV)/.installed $(PAGE)

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

# Versions are pinned in constraints.txt; pyproject.toml has the ranges.
$(VENV)/.installed: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e .
	touch $@

$(VENV)/.tools: pyproject.toml constraints.txt $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[test,dev,docs]"
	touch $@

web/node_modules/.installed: web/package-lock.json
	cd web && npm ci --no-audit --no-fund
	touch $@

$(PAGE): web/node_modules/.installed $(WEB)
	cd web && npm run build
	touch $@

demo: setup
	$(BIN)/seacrane demo $(ARGS)

# The browser tests drive Debian's chromium; as root it is installed, else the command to do so is named.
browser:
	@command -v chromium >/dev/null || { [ "$$(id -u)" = 0 ] && apt-get update -qq && \
	  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium; } || \
	  { echo "The browser tests need chromium: sudo apt-get install chromium"; exit 1; }

# What runs by the clock or in a browser runs alone, after all else on two workers in the order of the files.
test: setup browser $(VENV)/.tools
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder $(addprefix --ignore=,$(BY_THE_CLOCK))
	$(BIN)/python -m pytest $(BY_THE_CLOCK)
	cd web && npm test

# The WebAssembly of the designer's load chart, kept beside its source so that a page is built without a C compiler.
load-chart:
	$(BIN)/python -m ziglang cc -target wasm32-freestanding -std=c99 -O2 -msimd128 -Wall -Wextra -Werror -nostdlib -s \
	  -Wl,--no-entry -Wl,--initial-memory=67108864 -o $(CHART).wasm web/core/design/loadChart.c

# Exported binaries for aarch64 Linux and Windows, run by emulators.
foreign-platforms: setup $(VENV)/.tools
	@command -v qemu-aarch64 >/dev/null && command -v wine >/dev/null && test -d /usr/aarch64-linux-gnu || \
	  { [ "$$(id -u)" = 0 ] && apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq \
	  --no-install-recommends qemu-user libc6-arm64-cross wine wine64; } || \
	  { echo "Needs: sudo apt-get install qemu-user libc6-arm64-cross wine wine64"; exit 1; }
	$(BIN)/python -m pytest -rs tests/conformance/test_conformance_platforms.py

check: setup $(VENV)/.tools
	$(BIN)/ruff format --check src tests examples benchmarks
	$(BIN)/ruff check src tests examples benchmarks
	$(BIN)/mypy
	$(BIN)/lint-imports
	cd web && npm run check
	$(BIN)/mkdocs build --strict

format:
	$(BIN)/ruff format src tests examples benchmarks
	$(BIN)/ruff check --fix src tests examples benchmarks
	cd web && npm run format

docs: $(VENV)/.tools
	$(BIN)/mkdocs serve

clean:
	rm -rf $(VENV) web/node_modules site src/seacrane/server/page
