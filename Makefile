# SPDX-License-Identifier: Apache-2.0
# The front door. Each target sets up what it needs first (scripts/setup/bootstrap.py), at once if nothing is missing.

PYTHON ?= python3
SIM    ?= icarus
HERE   := $(filter-out ./,$(dir $(firstword $(MAKEFILE_LIST))))
VENV   := $(if $(HERE),env PYTHONPATH=$(HERE) )$(HERE).venv/bin/python
SETUP   = $(PYTHON) -ES $(HERE)scripts/setup/bootstrap.py

ifneq ($(value SIM),icarus)
ifneq ($(value SIM),verilator)
$(error unknown simulator SIM=$(value SIM): use icarus or verilator)
endif
endif

# What each target takes on the command line; anything else there is a slip, and is named.
PATHS          := SIM OUT DATAPATH WIDTH
TAKES_report   := TRAJECTORY $(PATHS) CORES AXIS ARM LIMB JOINTS UP TWIST SCALE D1 D2 PHI POLE SOFT ROBOT BASE TIP BAR
TAKES_run      := $(TAKES_report) WAVES
TAKES_follow   := $(TAKES_run) TARGET
TAKES_soak     := $(PATHS) TARGETS SEED FROM KEEP AGAIN SPECIAL FARM AGAINST
TAKES_soak-memory := SIM JOBS SEED FROM
TAKES_test     := SIM CORES ONLY
TAKES_test-all := SIM CORES
TAKES_test-browser := SIM ONLY
TAKES_coverage := ONLY KEEP
TAKES_formal   := ONLY
TAKES_mutants  := COUNT SEED ONLY OUT KEEP FARM
TAKES_fpga     := DATAPATH WIDTH FARM
TAKES_farm-worker := FARM JOBS
TAKES_paper    := ONLY
TAKES_schedule := DATAPATH PERIOD SECONDS
TAKES_playground := OUT DATAPATH WIDTH
$(foreach target,setup docs,$(eval TAKES_$(target) := SIM))
GOALS := $(or $(MAKECMDGOALS),help)
# From another folder, by make -f, with paths as seen from there: what runs the core. The rest works on the checkout.
ifneq ($(and $(HERE),$(filter-out help setup run follow report soak,$(GOALS))),)
$(error make $(GOALS) works in its own folder: make -C $(HERE) $(GOALS))
endif
$(if $(wildcard $(if $(HERE),$(HERE)scripts/setup,.)),,$(error make -f takes no path with spaces: use make -C))
GIVEN := $(foreach v,$(.VARIABLES),$(if $(filter command,$(origin $v)),$v))
TAKEN := $(sort $(foreach goal,$(GOALS),$(TAKES_$(goal))))
WRONG := $(filter-out PYTHON $(TAKEN),$(GIVEN))
ifneq ($(WRONG),)
$(error make $(GOALS) takes no variable $(firstword $(WRONG)): it takes $(or $(TAKEN),none))
endif
switch = $(if $(filter command,$(origin $1)),$(if $(filter-out 0 1,$(value $1))$(word 2,$(value $1)),$(error $1=$(value $1): use 1 or 0)))
$(foreach v,WAVES KEEP SPECIAL,$(call switch,$v))

CORES ?= behavioural
ifneq ($(value CORES),behavioural)
ifneq ($(value CORES),digit)
$(error unknown cores CORES=$(value CORES): use behavioural or digit)
endif
endif
unexport CORES

# Options of `make run`, `follow`, `report`, `soak` and `test`, from make's command line only. A value is never expanded by
# make and reaches the command as a quoted shell variable, so that a path with spaces, quotes or $ arrives as it was typed.
OPTIONS := TRAJECTORY OUT DATAPATH WIDTH WAVES AXIS ARM LIMB JOINTS UP TWIST SCALE D1 D2 PHI POLE SOFT ROBOT BASE TIP BAR TARGET TARGETS JOBS COUNT SEED FROM KEEP AGAIN AGAINST ONLY PERIOD SECONDS FARM
$(foreach o,$(OPTIONS),$(eval export CGA_$o := $$(value $o)))
unexport $(OPTIONS)
# The user's are of another Python; without bytecode each simulation compiles the same modules again.
unexport PYTHONPATH PYTHONHOME PYTHONSAFEPATH PYTHONDONTWRITEBYTECODE PYTHONWARNINGS
# Caches of Yosys, nextpnr and zig stay in the checkout.
export YOWASP_CACHE_DIR ?= $(if $(HERE),$(abspath $(HERE)),$(CURDIR))/.venv/cache/yowasp
export ZIG_GLOBAL_CACHE_DIR ?= $(if $(HERE),$(abspath $(HERE)),$(CURDIR))/.venv/cache/zig
MAKEOVERRIDES :=
given = $(if $(filter command,$(origin $1)),$(if $(value $1),$2))
job = --sim $(SIM) $(if $(filter digit,$(CORES)),--cores digit) \
  $(call given,TRAJECTORY,--trajectory="$$CGA_TRAJECTORY") $(call given,OUT,--out="$$CGA_OUT") \
  $(call given,DATAPATH,--datapath="$$CGA_DATAPATH") $(call given,WIDTH,--width="$$CGA_WIDTH") \
  $(call given,AXIS,--axis="$$CGA_AXIS") $(call given,ARM,--arm="$$CGA_ARM") $(call given,JOINTS,--joints="$$CGA_JOINTS") \
  $(call given,LIMB,--limb="$$CGA_LIMB") \
  $(call given,UP,--up="$$CGA_UP") $(call given,TWIST,--twist="$$CGA_TWIST") $(call given,SCALE,--scale="$$CGA_SCALE") \
  $(call given,D1,--d1="$$CGA_D1") $(call given,D2,--d2="$$CGA_D2") $(call given,PHI,--phi="$$CGA_PHI") \
  $(call given,POLE,--pole="$$CGA_POLE") $(call given,SOFT,--soft="$$CGA_SOFT") \
  $(call given,ROBOT,--robot="$$CGA_ROBOT") $(call given,BASE,--base="$$CGA_BASE") $(call given,TIP,--tip="$$CGA_TIP") \
  $(call given,BAR,--bar="$$CGA_BAR")

waves = $(if $(filter-out 0,$(call given,WAVES,$(value WAVES))),--waves)

.PHONY: help setup run follow report test test-all test-browser coverage docs paper playground schedule soak soak-memory mutants farm-worker lint formal check-proofs release-check fpga lock clean distclean

help: # print this list
	@sed -n 's/^\([a-z0-9-]*\):[^#]*## \(.*\)/  make \1@\2/p' $(firstword $(MAKEFILE_LIST)) | awk -F@ '{printf "%-23s%s\n", $$1, $$2}'

setup: ## create .venv and install the simulator [SIM=icarus|verilator]; targets that need them do this too
	@$(SETUP) checkout $(sort icarus $(SIM))

run: ## simulate the core and score its results [TRAJECTORY=name|all|file.csv|clip.bvh OUT=dir SIM= DATAPATH= WIDTH= CORES= WAVES=1 AXIS=z|-z|x|...|X,Y,Z|torso D1= D2= PHI=rad|clip|constant POLE=X,Y,Z|joint SOFT=0..1 BAR=; of hands ROBOT=iiwa14|human|file.urdf BASE=link TIP=link; of a clip ARM=both|left|right LIMB=arms|legs|all JOINTS=shoulder,elbow,wrist UP=y|-z|... TWIST=clip|core SCALE=auto|m|cm|mm|inch|cmu]
	@$(SETUP) $(SIM)
	@exec $(VENV) -m scripts.run $(job) $(waves)

follow: ## print every node of one target, RTL next to model [TARGET=0.. WAVES=1 and the options of run]
	@$(SETUP) $(SIM)
	@exec $(VENV) -m scripts.follow $(job) $(call given,TARGET,--target="$$CGA_TARGET") $(waves)

report: ## run and write an HTML page: the arm in motion, errors, pipeline [options of run except WAVES]
	@$(SETUP) checkout $(SIM)
	@exec $(VENV) -m scripts.report $(job)

# With SIM=verilator only tests that start a simulator: the others do not depend on it. ONLY also picks slow cases.
only_sim = not release$(if $(filter verilator,$(SIM)), and sim)
quick    = $(if $(call given,ONLY,yes),, and not slow)
pytest   = SIM=$(SIM) IK_CORES=$(CORES) exec $(VENV) -m pytest -n auto --dist loadfile --no-loadscope-reorder \
  $(call given,ONLY,$$(test -e "$${CGA_ONLY%%::*}" || echo -k) "$$CGA_ONLY")

test: ## quick tests [SIM=icarus, or verilator: simulations only; CORES=behavioural|digit ONLY=file or pattern: slow ones as well]
	@$(SETUP) checkout $(sort icarus $(SIM))
	@$(pytest) -m "$(only_sim)$(quick)"

test-all: ## all tests except those marked release [SIM=icarus, or verilator: simulations only; CORES=behavioural|digit]
	@$(SETUP) checkout $(sort icarus verilator $(SIM)) fpga farm litex
	@$(pytest) -m "$(only_sim)"

test-browser: ## test report and playground in headless Chromium [SIM=icarus|verilator ONLY=pattern: slow tests as well]
	@$(SETUP) checkout $(SIM) chromium playground
	@SIM=$(SIM) exec $(VENV) -m pytest -n auto --dist loadfile \
	  scripts/report/tests/browser_test_*.py scripts/playground/tests/browser_test_*.py \
	  $(call given,ONLY,-k "$$CGA_ONLY") -m "not release$(quick)"

coverage: ## measure Verilog coverage of the tests: build/coverage/annotated [ONLY=pattern; KEEP=1: coverage.md]
	@$(SETUP) checkout verilator
	@exec $(VENV) -m scripts.coverage $(call given,ONLY,--only="$$CGA_ONLY") $(if $(filter-out 0,$(call given,KEEP,$(value KEEP))),--keep)

docs: ## write scores.md, latency.md, registers.md, memory.md and the generated headers
	@$(SETUP) checkout $(SIM)
	@exec $(VENV) -m scripts.generate.headers
	@exec $(VENV) -m scripts.generate.registers
	@exec $(VENV) -m scripts.generate.pages --sim $(SIM)

paper_needs_figures := graphviz
paper_needs_table6  := table6

paper: ## write the pages of comparison with the paper: derivation, table 4, word lengths, figures 6 and 7, table 6 [ONLY=derivation|operations|wordlengths|figures|table6]
	@$(SETUP) checkout icarus $(if $(call given,ONLY,yes),$(paper_needs_$(value ONLY)),graphviz table6)
	@exec $(VENV) -m scripts.paper $(call given,ONLY,--only="$$CGA_ONLY")

playground: ## write a page that runs the Verilog: build/playground/index.html; takes minutes the first time [DATAPATH=name,name WIDTH= OUT=dir]
	@$(SETUP) checkout playground
	@exec $(VENV) -m scripts.playground $(call given,OUT,--out="$$CGA_OUT") \
	  $(call given,DATAPATH,--datapath="$$CGA_DATAPATH") $(call given,WIDTH,--width="$$CGA_WIDTH")

schedule: ## reschedule a program of the folded datapath after a change of its dataflow [DATAPATH=fold|fold_arm PERIOD= SECONDS=]
	@$(SETUP) checkout icarus schedule
	@exec $(VENV) -m scripts.generate.fold_scheduler $(call given,DATAPATH,--datapath="$$CGA_DATAPATH") \
	  $(call given,PERIOD,--period="$$CGA_PERIOD") $(call given,SECONDS,--seconds="$$CGA_SECONDS")

# Verilator, unless SIM was set: Icarus takes several times as long. FARM= needs what gives work to others.
farm     = $(call given,FARM, farm)
soak_sim = $(if $(filter file,$(origin SIM)),verilator,$(SIM))

soak: ## compare every node of random targets with the model [TARGETS= SEED= FROM=chunk DATAPATH= WIDTH= OUT= SIM= KEEP=1 AGAIN=file SPECIAL=1 AGAINST=c FARM=]
	@$(SETUP) $(soak_sim)$(farm)
	@exec $(VENV) -m scripts.soak --sim $(soak_sim) \
	  $(call given,TARGETS,--targets="$$CGA_TARGETS") $(call given,SEED,--seed="$$CGA_SEED") \
	  $(call given,DATAPATH,--datapath="$$CGA_DATAPATH") $(call given,WIDTH,--width="$$CGA_WIDTH") \
	  $(call given,OUT,--out="$$CGA_OUT") $(call given,AGAIN,--again="$$CGA_AGAIN") \
	  $(call given,FROM,--from="$$CGA_FROM") $(call given,FARM,--farm="$$CGA_FARM") \
	  $(call given,AGAINST,--against="$$CGA_AGAINST") \
	  $(if $(filter-out 0,$(call given,KEEP,$(value KEEP))),--keep) \
	  $(if $(filter-out 0,$(call given,SPECIAL,$(value SPECIAL))),--special)

soak-memory: ## run random memory-to-memory jobs of ik_axi [JOBS= SEED= FROM=piece SIM=]
	@$(SETUP) checkout $(soak_sim)
	@exec $(VENV) -m scripts.soak_memory --sim $(soak_sim) $(call given,JOBS,--jobs="$$CGA_JOBS") \
	  $(call given,SEED,--seed="$$CGA_SEED") $(call given,FROM,--from="$$CGA_FROM")

mutants: ## run netlist mutants, each of which a bench must kill [COUNT= SEED= ONLY=file OUT= FARM=; KEEP=1: mutants.md]
	@$(SETUP) checkout icarus fpga$(farm)
	@exec $(VENV) -m scripts.mutants $(call given,COUNT,--count="$$CGA_COUNT") $(call given,SEED,--seed="$$CGA_SEED") \
	  $(call given,ONLY,--only="$$CGA_ONLY") $(call given,OUT,--out="$$CGA_OUT") $(call given,FARM,--farm="$$CGA_FARM") \
	  $(if $(filter-out 0,$(call given,KEEP,$(value KEEP))),--keep)

farm-worker: ## make this machine a worker of a scheduler, after installing the tools [FARM=tcp://scheduler:8786 JOBS=]
	@$(SETUP) checkout icarus verilator fpga farm
	@exec $(VENV) -m scripts.parallel $(call given,FARM,--farm="$$CGA_FARM") $(call given,JOBS,--jobs="$$CGA_JOBS")

lint: ## lint every module as its own top with Verilator, Icarus and slang; check style, imports, licences and types of the Python
	@$(SETUP) checkout icarus lint
	@exec $(VENV) -m scripts.lint

formal: ## prove streams, divider, root and ranges; each proof must fail on a seeded bug: proofs.md [ONLY=name]
	@$(SETUP) checkout fpga
	@exec $(VENV) -m scripts.formal $(call given,ONLY,--only="$$CGA_ONLY")

check-proofs: # list stale pages of proofs and measurements
	@$(SETUP) checkout
	@exec $(VENV) -m scripts.check_proofs

release-check: ## before a release: fail on stale pages of proofs or measurements; run the tests marked release
	@$(SETUP) checkout icarus verilator fpga farm arms
	@$(VENV) -m scripts.check_proofs --strict
	@SIM=$(SIM) exec $(VENV) -m pytest -n auto --dist loadfile --no-loadscope-reorder -m release

fpga: ## measure size and clock of the datapaths with open tools, for the paper's table 5: fpga.md [DATAPATH=lean|lean25|paper|memory|fold|fold_arm WIDTH= FARM=]
	@$(SETUP) checkout fpga$(farm)
	@exec $(VENV) -m scripts.fpga $(call given,DATAPATH,--datapath="$$CGA_DATAPATH") $(call given,WIDTH,--width="$$CGA_WIDTH") \
	  $(call given,FARM,--farm="$$CGA_FARM")

compile = uv pip compile --quiet --universal --python-version 3.10 --upgrade --generate-hashes --no-emit-index-url \
  --no-emit-find-links --custom-compile-command "make lock"

lock: ## regenerate the lock files of requirements/ (needs uv)
	$(compile) --extra checkout --output-file requirements/checkout.lock pyproject.toml
	$(compile) --extra run --constraint requirements/checkout.lock --output-file requirements/run.lock pyproject.toml
	for name in fpga table6 schedule playground farm litex arms; do $(compile) --constraint requirements/checkout.lock \
	  $$(test $$name != playground || echo --constraint requirements/fpga.lock) \
	  --output-file requirements/$$name.lock --group pyproject.toml:$$name || exit; done

clean: ## remove build/ and caches; distclean removes .venv as well
	rm -rf build .pytest_cache .ruff_cache .hypothesis
	@find . \( -path ./.venv -o -path ./.git \) -prune -o -type d -name __pycache__ -prune -exec rm -rf {} +

distclean: clean
	rm -rf .venv
