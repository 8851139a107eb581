# Needs Python 3.11 to 3.13 and make; everything else goes into .venv.
.PHONY: run smoke test check lock clean

CORES ?= 2
PYTHON ?= $(shell for python in python3 python3.13 python3.12 python3.11; do \
	$$python -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 14))' 2>/dev/null \
	&& echo $$python && break; done)
BIN := .venv/bin

run: .venv/ready
	$(BIN)/snakemake --cores $(CORES)

smoke: .venv/ready
	$(BIN)/snakemake --cores $(CORES) --configfile config/smoke.yaml

test: .venv/ready
	$(BIN)/python -m pytest -n $(CORES)

check: .venv/ready
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/snakemake --lint
	$(BIN)/dnawaves check config/config.yaml
	$(BIN)/dnawaves check config/smoke.yaml
	$(BIN)/dnawaves check config/paper.yaml

clean:
	rm -rf .venv .venv-lock .snakemake
	find results -mindepth 1 -maxdepth 1 ! -name README.md -exec rm -rf {} +

.venv/locked: requirements.lock
	@test -n "$(PYTHON)" || { echo "make: no Python 3.11, 3.12 or 3.13 was found" >&2; exit 1; }
	@echo "Setting up .venv: about a minute, once"
	$(PYTHON) -m venv --clear .venv
	$(BIN)/python -m pip install --quiet --require-hashes --no-deps --prefer-binary \
		--requirement requirements.lock
	@touch $@

# Hatchling comes with the lock: without isolation nothing is downloaded here.
.venv/ready: .venv/locked pyproject.toml
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	@touch $@

# Its own environment, so that a lock that cannot be installed can still be mended.
lock:
	@test -x .venv-lock/bin/uv || { $(PYTHON) -m venv .venv-lock && \
		.venv-lock/bin/python -m pip install --quiet uv; }
	.venv-lock/bin/uv pip compile --quiet --upgrade --universal --python-version 3.11 \
		--generate-hashes --no-emit-index-url --no-emit-find-links \
		--custom-compile-command 'make lock' \
		--group dev --output-file requirements.lock pyproject.toml
