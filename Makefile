# On a fresh machine: `make sweep_nu` flies the study and reports, `make test` runs every test. Both build .venv first, once.
PYTHON ?= python3
BIN := .venv/bin

.PHONY: sweep_nu test check bench lock clean

sweep_nu: .venv
	@$(BIN)/python -m scenarios.run sweep_nu

test: .venv
	@$(BIN)/python -m pytest -n 2 --dist loadfile

check: .venv
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: .venv
	@$(BIN)/python -m benchmarks.closed_loop

.venv: .venv/.installed

.venv/.installed: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "error: $(PYTHON) is older than Python 3.11; name a newer one: make PYTHON=python3.12"; exit 2; }
	@echo "building .venv, once"
	@$(PYTHON) -m venv .venv || \
		{ echo "error: $(PYTHON) cannot make environments; install its venv package (Debian: apt install python3-venv)"; exit 2; }
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	@touch $@

lock: .venv
	@{ echo '# Pinned versions of everything the environment holds. `make lock` writes this file anew.'; \
		$(BIN)/python -m pip freeze --exclude-editable; } > constraints.txt

clean:
	rm -rf .venv runs
