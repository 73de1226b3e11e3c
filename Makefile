# armodal: every target makes its own environment in .venv from the pinned constraints.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check
STAMP := $(VENV)/.installed
BENCH_STAMP := $(VENV)/.installed-bench
# The board's device library, compiled for this machine: the simulated board runs on it.
DEVICE_LIBRARY := protocols/c/build/libarmodal_board.so
DEVICE_SOURCES := $(wildcard protocols/c/src/* protocols/c/include/*) protocols/c/build.py
# A file at a time: what its tests share is made once. One more than processors: where one waits for
# a device another computes.
WORKERS = -n $(shell $(BIN)/python -c 'import os; print((os.cpu_count() or 1) + 1)') --dist loadfile
# Matrices here are small: one BLAS thread is faster than many.
export OPENBLAS_NUM_THREADS = 1
export OMP_NUM_THREADS = 1
export MKL_NUM_THREADS = 1
# What one process has compiled the next need not: tests start some fifty.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo docs messages firmware firmware-check test test-all coverage check bench torture fuzz hashes sizes format clean setup

setup: $(DEVICE_LIBRARY)

# With HASHED=1, for CI: every package the project needs, for its benches too, and none whose hash
# is not in constraints-hashed.txt. setuptools first, since it builds what comes as source. All that a
# package needs is listed too: one half is installed beside the other. Python compiles what it imports.
ifdef HASHED
define INSTALL
sed -n '/^setuptools==/,/[^\\]$$/p' constraints-hashed.txt > $(VENV)/setuptools.txt
$(PIP) --require-hashes --requirement $(VENV)/setuptools.txt
awk -v to=$(VENV) '/^[^ ]/ { n += 1 } { print > (to "/part-" n % 2 ".txt") }' constraints-hashed.txt
$(PIP) $(PINNED) --requirement $(VENV)/part-0.txt & first=$$!; \
	$(PIP) $(PINNED) --requirement $(VENV)/part-1.txt && wait $$first
$(PIP) --no-deps --no-build-isolation --editable .
$(BIN)/python -m pip check
endef
PINNED := --no-compile --no-deps --require-hashes --no-build-isolation
else
INSTALL = $(PIP) --constraint constraints.txt --editable '.[dev]'
endif

$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "armodal needs Python 3.11 or newer; this is " + sys.version.split()[0] + ". Try: make PYTHON=python3.12")'
	$(PYTHON) -m venv $(VENV)
	$(INSTALL)
	@touch $@

# What the benches measure themselves against.
$(BENCH_STAMP): $(STAMP)
	$(PIP) --constraint constraints.txt --editable '.[bench]'
	@touch $@

$(DEVICE_LIBRARY): $(STAMP) $(DEVICE_SOURCES)
	$(BIN)/python -m armodal.protocols.c.build
	@touch $@

demo: $(DEVICE_LIBRARY)
	$(BIN)/armodal demo

# With SHARE=K/N, part K of N of the long tests too, in the same run.
test: $(DEVICE_LIBRARY)
	$(BIN)/python -m pytest $(if $(SHARE),--share $(SHARE),-m "not long") $(WORKERS)

test-all: $(DEVICE_LIBRARY)
	$(BIN)/python -m pytest $(WORKERS)

# Lines and branches that `make test` runs, in the processes it starts too.
coverage: $(DEVICE_LIBRARY)
	$(BIN)/coverage erase
	$(BIN)/coverage run -m pytest -m "not long" $(WORKERS)
	$(BIN)/coverage combine --quiet
	$(BIN)/coverage report

check: $(STAMP)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# The site, in build/site: its warnings are errors, and its notebooks are run. What it needs is there
# with HASHED=1.
docs: $(DEVICE_LIBRARY)
ifndef HASHED
	$(PIP) --constraint constraints.txt --editable '.[docs]'
endif
	$(BIN)/python -m sphinx --jobs auto -b html -W --keep-going -q docs build/site

bench: $(DEVICE_LIBRARY) $(BENCH_STAMP)
	for script in bench/bench_*.py; do PYTHONPATH=tests $(BIN)/python $$script || exit 1; done

# What docs/reliability.md promises, at length.
torture: $(DEVICE_LIBRARY)
	$(PIP) --constraint constraints.txt --editable '.[fuzz,ni,opendaq]'
	$(BIN)/python bench/torture.py

# The versions of constraints.txt once more, with the hash of each of their files on any system.
hashes:
	$(PYTHON) -m venv build/hashes
	build/hashes/bin/python -m pip install --quiet --disable-pip-version-check uv
	build/hashes/bin/uv pip compile constraints.txt --quiet --no-config --no-deps --universal \
		--python-version 3.11 --generate-hashes --no-header --no-annotate --output-file constraints-hashed.txt

# What is made from the table of messages, protocols/board/records.py.
messages: $(STAMP)
	$(BIN)/python -m armodal.protocols.board.generate
	$(BIN)/python tests/vectors/make_board_vectors.py

# The boards of docs/porting.md, section 2, and every step of the check on them.
firmware: $(STAMP)
	$(BIN)/python -m armodal.protocols.c.firmware

firmware-check: firmware
	$(BIN)/python -m pytest tests/daq/test_firmware.py

# Every decoder, five minutes each, with its coverage watched.
fuzz: $(DEVICE_LIBRARY)
	$(PIP) --constraint constraints.txt --editable '.[fuzz]'
	$(BIN)/python bench/fuzz.py

sizes: $(STAMP)
	$(BIN)/python -m armodal.protocols.c.sizes

format: $(STAMP)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean:
	rm -rf $(VENV) build protocols/c/build *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis .coverage .coverage.* .import_linter_cache
