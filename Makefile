# SPDX-License-Identifier: Apache-2.0
# The front door. Each target sets up what it needs first (scripts/setup/bootstrap.py), at once if nothing is missing.

PYTHON ?= python3
SIM    := icarus
# With `make -f CHECKOUT/Makefile`, paths are relative to the present folder.
HERE   := $(filter-out ./,$(dir $(firstword $(MAKEFILE_LIST))))
SETUP   = $(PYTHON) -ES $(HERE)scripts/setup/bootstrap.py
VENV    = $(if $(HERE),env PYTHONPATH=$(HERE) )$(HERE).venv/bin/python
RUN     = exec $(VENV) -m

# Variables of make's command line become words of the command, OUT=x as it was typed: make does not expand the value, and
# it reaches the command as a quoted shell variable. scripts/console.py turns the word into the option --out.
TYPED := $(filter-out PYTHON,$(foreach v,$(.VARIABLES),$(if $(filter command,$(origin $v)),$v)))
$(foreach v,$(TYPED),$(eval export CGA_$v := $$(value $v))$(eval unexport $v))
MAKEOVERRIDES :=
WORDS := $(foreach v,$(TYPED),$v="$$CGA_$v")

ifneq ($(filter-out icarus verilator,$(value SIM)),)
$(error unknown simulator SIM=$(value SIM): use icarus or verilator)
endif
# Soaks run under Verilator unless SIM= is given: Icarus takes several times as long. FARM= needs Dask.
SOAK_SIM := $(if $(filter SIM,$(TYPED)),$(SIM),verilator)
FARM_LOCK = $(if $(filter FARM,$(TYPED)), farm)

# The user's are of another Python; without bytecode each simulation compiles the same modules again.
unexport PYTHONPATH PYTHONHOME PYTHONSAFEPATH PYTHONDONTWRITEBYTECODE PYTHONWARNINGS
# Caches of Yosys, nextpnr and zig stay in the checkout.
export YOWASP_CACHE_DIR ?= $(abspath $(HERE).)/.venv/cache/yowasp
export ZIG_GLOBAL_CACHE_DIR ?= $(abspath $(HERE).)/.venv/cache/zig

.PHONY: help clean $(MAKECMDGOALS)

help: # print this list
	@sed -n 's/^\([a-z-]*\):.* ## \(.*\)/make \1@\2/p' $(firstword $(MAKEFILE_LIST)) | awk -F@ '{printf "%-19s%s\n", $$1, $$2}'
	@echo "make run HELP=1 lists options of run: with make, --out DIR is OUT=DIR, and --waves is WAVES=1"

setup: ## install the packages and the simulator that run and test need
	@$(SETUP) checkout $(sort icarus $(SIM))

run: ## simulate the core and score its results
	@$(SETUP) $(SIM)
	@$(RUN) scripts.run $(WORDS)

follow: ## print every node of one target, RTL next to model
	@$(SETUP) $(SIM)
	@$(RUN) scripts.follow $(WORDS)

report: ## run and write an HTML page: arm in motion, errors, pipeline
	@$(SETUP) checkout $(SIM)
	@$(RUN) scripts.report $(WORDS)

soak: ## compare every node of random targets with the model
	@$(SETUP) $(SOAK_SIM)$(FARM_LOCK)
	@$(RUN) scripts.soak $(WORDS)

soak-memory: ## run random memory-to-memory jobs of ik_axi
	@$(SETUP) checkout $(SOAK_SIM)
	@$(RUN) scripts.soak_memory $(WORDS)

test: ## run the quick tests; SIM=verilator runs simulations only
	@$(SETUP) checkout $(sort icarus $(SIM)) cc
	@$(RUN) scripts.test quick $(WORDS)

test-all: ## run the tests that make test leaves out, except those marked release
	@$(SETUP) checkout icarus verilator cc lint fpga litex
	@$(RUN) scripts.test slow $(WORDS)

test-browser: ## test report and playground in headless Chromium
	@$(SETUP) checkout $(SIM) browser playground
	@$(RUN) scripts.test browser $(WORDS)

release-check: ## run the tests marked release; fail on stale pages of proofs
	@$(SETUP) checkout icarus verilator cc clang ghdl fpga farm table6 arms
	@$(VENV) -m scripts.check_proofs --strict
	@$(RUN) scripts.test release $(WORDS)

lint: ## lint Verilog and Python; check imports, types, licences
	@$(SETUP) checkout icarus lint
	@$(RUN) scripts.lint $(WORDS)

formal: ## prove streams, arithmetic and ranges: proofs.md
	@$(SETUP) checkout fpga
	@$(RUN) scripts.formal $(WORDS)

mutants: ## run netlist mutants, each of which a bench must kill
	@$(SETUP) checkout icarus fpga$(FARM_LOCK)
	@$(RUN) scripts.mutants $(WORDS)

coverage: ## measure the Verilog coverage of the tests
	@$(SETUP) checkout verilator
	@$(RUN) scripts.coverage $(WORDS)

docs: ## write the generated headers, scores.md, latency.md; MEMORY=1 memory.md too
	@$(SETUP) checkout $(SIM)
	@$(VENV) -m scripts.generate.headers
	@$(VENV) -m scripts.generate.registers
	@$(RUN) scripts.generate.pages $(WORDS)

paper_needs_figures := graphviz
paper_needs_table6  := table6

paper: ## write the pages of comparison with the paper
	@$(SETUP) checkout icarus $(if $(filter ONLY,$(TYPED)),$(paper_needs_$(ONLY)),graphviz table6)
	@$(RUN) scripts.paper $(WORDS)

fpga: ## measure size and clock of the datapaths with open tools: fpga.md
	@$(SETUP) checkout fpga$(FARM_LOCK)
	@$(RUN) scripts.fpga $(WORDS)

asic: ## measure area and clock of the cores in standard cells: fpga.md
	@$(SETUP) checkout verilator fpga asic
	@$(RUN) scripts.fpga --datapath asic $(WORDS)

schedule: ## reschedule a program of the folded datapath
	@$(SETUP) checkout icarus schedule
	@$(RUN) scripts.generate.fold_scheduler $(WORDS)

playground: ## write a page that runs the Verilog; takes minutes at first
	@$(SETUP) checkout playground
	@$(RUN) scripts.playground $(WORDS)

farm-worker: ## make this computer a worker of a scheduler: FARM=tcp://HOST:PORT
	@$(SETUP) checkout icarus verilator fpga farm
	@$(RUN) scripts.parallel $(WORDS)

check-proofs: # list stale pages of proofs and measurements
	@$(SETUP) checkout
	@$(RUN) scripts.check_proofs $(WORDS)

compile = uv pip compile --quiet --universal --python-version 3.10 --upgrade --generate-hashes --no-emit-index-url \
  --no-emit-find-links --custom-compile-command "make lock"

lock: # regenerate the lock files of requirements/ (needs uv)
	$(compile) --extra checkout --output-file requirements/checkout.lock pyproject.toml
	$(compile) --extra run --constraint requirements/checkout.lock --output-file requirements/run.lock pyproject.toml
	for name in fpga table6 schedule playground browser farm litex arms; do $(compile) --constraint requirements/checkout.lock \
	  $$(test $$name != playground || echo --constraint requirements/fpga.lock) \
	  --output-file requirements/$$name.lock --group pyproject.toml:$$name || exit; done

clean: ## remove build/ and caches; distclean removes .venv as well
	@cd $(or $(HERE),.) && rm -rf build .pytest_cache .ruff_cache .hypothesis && find . \( -path ./.venv -o -path ./.git \) \
	  -prune -o -type d -name __pycache__ -prune -exec rm -rf {} +

distclean: clean
	rm -rf $(HERE).venv
