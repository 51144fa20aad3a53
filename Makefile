# nurbs_lab: `make help` lists what you can do.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/ready

# Headless pictures for the targets that run without a person; live sessions keep the interactive view.
HEADLESS := PYVISTA_OFF_SCREEN=true PYVISTA_JUPYTER_BACKEND=static NURBS_LAB_PROGRESS=0
# One thread per process: the tests already use every core.
QUIET    := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

# Folders of the quick tests.
QUICK    := $(addprefix nurbs_lab/tests/,nurbs mesh motion common test_house.py)

CHROMIUM := $(shell command -v chromium || command -v chromium-browser || command -v google-chrome)

.DEFAULT_GOAL := help
.PHONY: help setup icarus lab tour test test-fast fuzz coverage mutants mutants-rtl walk commands test-browser test-linuxcnc sim branches notebooks book bench synth bitstream netlist proofs lint clean

help: ## list the targets
	@awk -F':.*## ' '/^[a-z-]+:.*## / {printf "  make %-13s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

setup: $(READY) icarus ## build the environment (all other targets do it by themselves)

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 14))' || \
	  { echo "nurbs_lab needs Python 3.11, 3.12 or 3.13; say which one with: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	@if command -v uv >/dev/null; then \
	  uv venv --quiet --allow-existing --python "$$(command -v $(PYTHON))" $(VENV) && \
	  uv pip install --quiet --python $(BIN)/python --constraint constraints.txt --build-constraint constraints.txt -e '.[test,cad,book]'; \
	else \
	  $(PYTHON) -m venv $(VENV) 2>/dev/null || { rm -rf $(VENV); $(call as_root,apt-get install -y -q python3-venv) && $(PYTHON) -m venv $(VENV); } || \
	    { echo "Python's venv module is missing; type: sudo apt install python3-venv"; exit 1; }; \
	  $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt -e '.[test,cad,book]'; \
	fi
	@mkdir -p $(VENV)/share/jupyter/lab/settings
	@echo '{"@jupyterlab/apputils-extension:notification": {"fetchNews": "false", "checkForUpdates": false}, "@jupyterlab/docmanager-extension:plugin": {"autosave": false}}' \
	  > $(VENV)/share/jupyter/lab/settings/overrides.json # JupyterLab asks nothing at its start, and saves when told to
	@echo "compiling the kernels once ..."
	@NURBS_LAB_PROGRESS=0 $(BIN)/python -m nurbs_lab.warm
	@touch $(READY)

icarus:
	@command -v iverilog >/dev/null || $(call as_root,apt-get update -q; apt-get install -y -q iverilog) || \
	  { command -v brew >/dev/null && brew install icarus-verilog; } || \
	  { echo "Icarus Verilog is missing; type: sudo apt install iverilog   (or: conda install -c conda-forge iverilog)"; exit 1; }

# Run a command as root if that needs no password; fail quietly otherwise.
as_root = { command -v apt-get >/dev/null && \
  if [ "$$(id -u)" = 0 ]; then sh -c '$(1)'; else sudo -n true 2>/dev/null && sudo -n sh -c '$(1)'; fi; } >/dev/null 2>&1

lab: setup ## open JupyterLab at the tour
	@$(BIN)/jupyter lab notebooks/00-tour.ipynb \
	  $$([ "$$(id -u)" != 0 ] || echo --allow-root) \
	  $$([ -n "$$DISPLAY$$WAYLAND_DISPLAY" ] || [ "$$(uname)" = Darwin ] || echo --no-browser)

tour: setup ## run the tour without a browser; leaves exports/00-tour.html
	@mkdir -p exports
	@$(HEADLESS) $(BIN)/jupyter nbconvert --to html --execute --embed-images --log-level WARN \
	  --ExecutePreprocessor.extra_arguments="['--IPKernelApp.log_level=40']" \
	  --template-file notebooks/page.html.j2 \
	  --output-dir exports notebooks/00-tour.ipynb
	@echo "the tour is in exports/00-tour.html"

test: setup ## run every test: package, notebooks, Verilog; JupyterLab too where Chromium is found
	@$(HEADLESS) $(QUIET) $(BIN)/python -m pytest -n 2 --dist loadscope --no-loadscope-reorder $(if $(CHROMIUM),,-m "not browser")

test-fast: setup ## the tests of the mathematics, in about a minute: no browser, notebooks, files or Verilog
	@$(HEADLESS) $(QUIET) $(BIN)/python -m pytest -q -n 2 $(QUICK)

fuzz: setup ## call every public name with hostile arguments: CALLS=20000 SEED=1; a table, and seeds that repeat
	@$(HEADLESS) $(QUIET) $(BIN)/python -m nurbs_lab.tests.robust.fuzz --calls $(or $(CALLS),20000) --seed $(or $(SEED),1)

coverage: setup ## lines of nurbs_lab that its own tests reach, kernels too; fails under 95 %
	@$(BIN)/python -m coverage erase
	@$(HEADLESS) $(QUIET) $(BIN)/python -m coverage run -m pytest -q -n 2 --dist loadscope -m "not browser" nurbs_lab
	@$(HEADLESS) $(QUIET) NUMBA_DISABLE_JIT=1 $(BIN)/python -m coverage run -m nurbs_lab.tests.robust.calls_parts
	@$(BIN)/python -m coverage combine -q && $(BIN)/python -m coverage report

mutants: setup ## does the suite notice a wrong core: break one operator at a time; benchmarks/mutants.json
	@$(QUIET) $(BIN)/python benchmarks/mutants.py

mutants-rtl: setup ## do benches and proofs notice wrong Verilog: rtl/mutants.json (15 minutes of a core; EACH=5 a module, QUICK=1 without larger benches)
	@$(QUIET) $(BIN)/python -m cocotb_tests.mutants $(MODULES)

walk: setup ## 10^5 random commands, stops and silences at the pins of the simulated board: EVENTS=1000 SEED=2 (needs g++)
	@$(QUIET) $(BIN)/python -m cocotb_tests.walk $(or $(EVENTS),100000) $(or $(SEED),1)

commands: setup ## 10^5 random overrides of jobs of 1,000 curves, Verilog and twin bit for bit: COMMANDS=3000 (needs g++)
	@$(QUIET) $(BIN)/python -m cocotb_tests.commands $(or $(COMMANDS),100000)

test-browser: setup ## the notebooks in a real JupyterLab (needs Chromium); leaves screenshots in exports/
	@$(QUIET) $(BIN)/python -m pytest nurbs_lab/tests/browser

test-linuxcnc: setup ## our programs in LinuxCNC's own interpreter; installs Debian's linuxcnc-uspace if it can
	@command -v rs274 >/dev/null || $(call as_root,apt-get update -q && apt-get install -y -q --no-install-recommends linuxcnc-uspace) || \
	  { echo "LinuxCNC is missing; type: sudo apt install linuxcnc-uspace"; exit 1; }
	@$(QUIET) $(BIN)/python -m pytest -m linuxcnc nurbs_lab/tests/interchange

sim: setup ## run the Verilog benches: BENCH=cu for one, WAVES=1 for a wave file, SEED=7 to repeat
	@$(QUIET) $(BIN)/python -m pytest -q -n 2 cocotb_tests $(if $(BENCH),-k $(BENCH))

branches: setup ## branches of the Verilog that the benches reach: the table of rtl/README.md
	@rm -f sim_build/*/branches.log
	@BRANCHES=1 $(QUIET) $(BIN)/python -m pytest -q -n 2 cocotb_tests -k "not formal and not lint and not paths and not bench"
	@$(BIN)/python -m cocotb_tests.branches

notebooks: setup ## re-execute all notebooks in place, strip the noise, make the pictures of the front page
	@$(HEADLESS) $(BIN)/python notebooks/regenerate.py
	@$(BIN)/python notebooks/gallery.py
	@$(HEADLESS) $(BIN)/python notebooks/hero.py

book: setup ## one static site of all notebooks, from their stored outputs, in exports/book
	@$(BIN)/python notebooks/book/build.py exports/book
	@echo "the book is in exports/book/index.html"

bench: setup ## this project beside its peers: benchmarks/README.md; ROOM=motion for one room
	@if command -v uv >/dev/null; then uv pip install --quiet --python $(BIN)/python --constraint constraints.txt -e '.[bench]'; \
	else $(BIN)/python -m pip install --quiet --constraint constraints.txt -e '.[bench]'; fi
	@NURBS_LAB_PROGRESS=0 $(BIN)/python -m nurbs_lab.warm
	@$(QUIET) NURBS_LAB_PROGRESS=0 $(BIN)/python -m benchmarks $(ROOM)

synth: setup ## cells, multipliers, clock of the Verilog: rtl/synthesis.json and the table of rtl/README.md
	@if command -v uv >/dev/null; then uv pip install --quiet --python $(BIN)/python --constraint constraints.txt -e '.[synth]'; \
	else $(BIN)/python -m pip install --quiet --constraint constraints.txt -e '.[synth]'; fi
	@$(BIN)/python rtl/synthesis/report.py

bitstream: setup ## exports/colorlight_i5.bit and its report in rtl/boards: SEEDS="1 2 3" for more placements
	@if command -v uv >/dev/null; then uv pip install --quiet --python $(BIN)/python --constraint constraints.txt -e '.[synth]'; \
	else $(BIN)/python -m pip install --quiet --constraint constraints.txt -e '.[synth]'; fi
	@$(BIN)/python rtl/synthesis/bitstream.py $(SEEDS)

netlist: setup ## one whole path in two netlists of each arrangement after synthesis (an hour, most of it `parallel`)
	@$(BIN)/python rtl/synthesis/netlist.py

proofs: setup ## the proofs of the Verilog that take minutes, and the quick ones: rtl/proofs.json
	@mkdir -p exports
	@$(QUIET) $(BIN)/python -m pytest -q --junit-xml=exports/proofs.xml cocotb_tests/test_formal.py cocotb_tests/long_proofs.py; \
	  passed=$$?; $(BIN)/python -m cocotb_tests.long_proofs exports/proofs.xml; exit $$passed

lint: setup ## style, import directions, Verilog
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@PATH="$(abspath $(BIN)):$$PATH" lint-imports
	@$(QUIET) $(BIN)/python -m pytest -q cocotb_tests/test_lint.py cocotb_tests/test_formal.py

clean: ## remove everything that can be built again
	rm -rf $(VENV) exports sim_build .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
