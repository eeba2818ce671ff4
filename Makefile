# On a fresh machine: `make sweep_nu` flies the study and reports, `make test` runs every test. Each installs what it
# needs into .venv, once.
#
# The system's own Python, if it is new enough and can make environments: it is compiled for speed. One that pyenv has
# compiled is not, unless told to, and flies a quarter slower. `make PYTHON=python3.12` takes another one.
SYSTEM_PYTHON := $(shell command -p python3 -c 'import sys, ensurepip; sys.exit(sys.version_info < (3, 11))' 2> /dev/null && \
	command -p -v python3)
PYTHON ?= $(or $(SYSTEM_PYTHON),python3)
BIN := .venv/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt

.PHONY: sweep_nu test test-quick fast check docs bench package lock clean

sweep_nu: .venv
	@$(BIN)/python -m scenarios.run sweep_nu

test: .venv/.developer
	@$(BIN)/python -m pytest -n 2 --dist worksteal

# Without what is marked slow: long flights, studies, stock aircraft, the browser, tutorials.
test-quick: .venv/.developer
	@$(BIN)/python -m pytest -n 2 --dist worksteal -m 'not slow'

# Compiles guidance and closed loop; needs a C compiler. Flights with them are compared with those of the sources, to
# the last bit.
fast: .venv/.developer
	@$(BIN)/python -m benchmarks.compiled
	@trap : INT TERM; $(BIN)/python -m pytest -n 2 tests/regression/compiled/compare_flights.py || \
		{ rm -rf build/compiled-*; echo "error: what was compiled was not shown to fly the same; the sources are run"; exit 1; }

check: .venv/.developer
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# From what is installed, without a network; a warning is an error.
docs: .venv/.docs
	@$(BIN)/python -m sphinx --nitpicky --fail-on-warning --keep-going --quiet docs docs/_build/html
	@echo "documentation: docs/_build/html/index.html"

# Of what `make fast` compiles, where it can be compiled; `PLUME_FLIGHT_SOURCES=1 make bench` of the sources.
bench: .venv/.developer
	@[ -n "$$PLUME_FLIGHT_SOURCES" ] || $(BIN)/python -c 'import gnc.compiled as c; c.compiled_modules() or exit(1)' || \
		$(MAKE) --no-print-directory fast || true
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python -m benchmarks.closed_loop

# Builds sdist and wheel, installs the wheel into an empty environment, and flies from it in an empty directory.
package: .venv/.developer
	@rm -rf build/package && mkdir -p build/package/empty
	@$(BIN)/python -m build --outdir build/package . > build/package/log 2>&1 || { tail -5 build/package/log; exit 1; }
	@$(PYTHON) -m venv build/package/.venv
	@build/package/.venv/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt build/package/*.whl
	@cd build/package/empty && ../.venv/bin/plume-flight run sweep_nu
	@ls build/package/*.whl build/package/*.tar.gz

.venv: .venv/.installed

.venv/.installed: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "error: $(PYTHON) is older than Python 3.11; name a newer one: make PYTHON=python3.12"; exit 2; }
	@echo "building .venv with $(PYTHON), once"
	@$(PYTHON) -m venv .venv || \
		{ echo "error: $(PYTHON) cannot make environments; install its venv package (Debian: apt install python3-venv)"; exit 2; }
	@$(INSTALL) -e .
	@touch $@

.venv/.developer: .venv/.installed
	@echo "installing the developers' tools into .venv, once"
	@$(INSTALL) -e '.[dev]'
	@touch $@

.venv/.docs: .venv/.installed
	@echo "installing what builds the documentation into .venv, once"
	@$(INSTALL) -e '.[docs]'
	@touch $@

lock: .venv/.developer .venv/.docs
	@{ echo '# Pinned versions of everything the environment holds. `make lock` writes this file anew.'; \
		$(BIN)/python -m pip freeze --exclude-editable; } > constraints.txt

# Runs stay: they may have taken hours.
clean:
	rm -rf .venv build docs/_build docs/generated
