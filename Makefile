# Each command first makes .venv, with this project and its development tools inside.
PYTHON ?= python3
BIN = .venv/bin

.PHONY: play demo test long durations slow stress stress-map coverage lint format bench docs examples lowest pythons same-bytes sdist picture reference-set clean

.venv/ready: pyproject.toml $(wildcard exact/compiled/*.[ch] floating/flat/*.c)
	$(PYTHON) -m venv .venv
	$(BIN)/pip install -q -e '.[dev]'
	touch $@

# Exit code 1 of a comparison means that the engines diverged: a result, not a failure.
demo: .venv/ready
	$(BIN)/truebreak compare gas --html report.html || test $$? -eq 1

# The page to play with, its engines in the browser itself; without their parts, which npm and pip fetch, those of a server.
play: .venv/ready
	$(BIN)/python docs/site/playground.py build/play --serve --open || test $$? -ne 77 || $(BIN)/truebreak play

test: .venv/ready
	$(BIN)/python -m pytest -n auto

# What takes over .4 s of CPU, a tenth of all tests at most, by tests/durations.json.
long: .venv/ready
	$(BIN)/python -m pytest -n auto -m long

# Runs both, and measures which tests belong to which; then the short ones alone, as some pay for what others had made.
durations: .venv/ready
	rm -f tests/durations.json
	$(BIN)/python -m pytest -n auto -m 'not slow' --keep-durations
	$(BIN)/python -m pytest -n auto --keep-durations

slow: .venv/ready
	$(BIN)/python -m pytest -n auto -m slow

# Goes on where the last call stopped; SCENES=N for another number, `tests/fuzz/stress.py --replay KIND SEED` for one.
stress: .venv/ready
	$(BIN)/python tests/fuzz/stress.py --scenes $(or $(SCENES),100000) --jobs 2 --out fuzz.jsonl

coverage: .venv/ready
	$(BIN)/python -m pytest -n auto -m 'not slow' --cov=scenarios --cov=tools --cov=exact --cov=floating --cov=compare --cov-report=term

lint: .venv/ready
	$(BIN)/ruff check . && $(BIN)/ruff format --check . && $(BIN)/pyright

format: .venv/ready
	$(BIN)/ruff check --fix-only . && $(BIN)/ruff format .

bench: .venv/ready
	$(BIN)/pip install -q -e '.[bench]'
	$(BIN)/python docs/studies/speed_ratios.py --full

# Builds the site: build/site/html/index.html.
docs: .venv/ready
	$(BIN)/python docs/site/build.py

# Runs every example of the README, of docs/ and of the docstrings.
examples: .venv/ready
	$(BIN)/python -m pytest -n auto -m 'not slow' tests/test_docs.py

# Tests that touch each dependency: for other versions of them, and of Python, than those of .venv.
TOUCHING = tests/exact/laws/test_laws.py tests/exact/literal/test_symbolic.py tests/exact/replay/test_ball_state.py \
    tests/exact/test_exact_values.py tests/floating/test_pymunk_engine.py tests/compare/chaos/test_chaos.py \
    tests/compare/cli/test_cli.py tests/compare/cli/test_command_line.py tests/compare/grids/test_sweep_extras.py \
    tests/compare/report/test_page.py tests/compare/report/test_terminal.py tests/compare/report/test_widget.py \
    tests/test_face.py tests/test_notebook.py tests/test_site.py

# The oldest versions that pyproject.toml declares, in an environment of their own.
lowest:
	mkdir -p build
	$(PYTHON) tests/lowest.py > build/lowest.txt
	$(PYTHON) -m venv build/lowest
	build/lowest/bin/pip install -q -c build/lowest.txt -e '.[dask,docs,notebook,plots,tables]' \
	    hypothesis jsonschema pytest pytest-timeout pytest-xdist 'setuptools>=77'
	build/lowest/bin/python -m pytest -n auto -m 'not slow' $(TOUCHING)

# Every Python that this machine has, from 3.11 on, each in an environment of its own.
pythons:
	$(PYTHON) tests/pythons.py build/pythons $(TOUCHING)

# The digest of the catalogue's histories in all ways that this machine has: Pythons, versions, kinds of numbers, WebAssembly.
same-bytes:
	$(PYTHON) tests/same_bytes.py build/same-bytes

# The distribution of sources, unpacked: its tests pass there, against the wheel that is built from it.
sdist:
	$(PYTHON) tests/sdist.py build/sdist

# Writes docs/report.png, the README's picture, from a report made now; needs chromium.
picture: .venv/ready
	SOURCE_DATE_EPOCH=0 $(BIN)/truebreak compare gas --html report.html --exit-zero
	$(BIN)/python tests/compare/report/browser.py report.html docs/report.png 1000 980

# Runs all stress families, and writes the map into docs/stress.md and docs/stress.svg; a test checks some of its places.
stress-map: .venv/ready
	$(BIN)/python docs/studies/stress_page.py docs/stress.md --store stress-map.db

# Writes docs/reference-set-1.zip; a test proves that it is current.
reference-set: .venv/ready
	$(BIN)/python tests/compare/certificate/reference_set.py

clean:
	rm -rf .venv build dist *.egg-info .pytest_cache .ruff_cache .hypothesis
