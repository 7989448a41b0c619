# SPDX-License-Identifier: Apache-2.0
# One Makefile over all parts; each part's rules are in its own folder. Results go to build/.
#   make           libshade and the shade tool: needs a C compiler, no more
#   make demo      from nothing to the pictures of both renderers and the verdict on them
#   make check     all tests
#   make blender   the add-on: build/libshade-blender.zip
#   make render    build/shade-render, which renders scenes that Blender saved, without Blender
#   make release-addon  the add-on for every Linux with glibc 2.28 or later: build/release/libshade-blender.zip
#   make release   all that others fetch: it, and library, tools and add-on for Linux, Windows and macOS, in build/release, with SHA256SUMS
#   make farm      build/libshade-farm, which spreads frames, tiles and shares over machines
#   make windows   library, shade, shade-render and the add-on for Windows: build/release/*-windows-x64.zip and SHA256SUMS
#   make macos     the same for macOS on arm64 and on x86-64: build/release/*-macos-*
#   make povray    POV-Ray with libshade: build/povray/povray
#   make povray-package  it as a package for Debian, beside Debian's own, and as an archive that runs from any folder
#   make compare   the demo, a normal map against the displaced truth, speed beside Cycles; a report of all, by a cluster with ENGINE=slurm
#   make compare-quick  a smaller report, in two minutes once all is built
#   make manual    build/manual/html/index.html, from docs/
#   make supported the tables of docs/blender/supported.md, from what the exporter reads
#   make manual-pictures  the pictures of the manual: nodes, what their sockets do, the cookbook of POV-Ray
#   make install   libshade, its headers, manual pages, tool and Python module to PREFIX (/usr/local); uninstall
#   make abi       the interface of the library as a text, libshade/abi/libshade.abi, which a test compares it with
#   make soak      all tests under sanitizers and as clang compiles them, a hundred million awkward cases, more of both renderers
#   make soak-machines  library, tool and renderer compiled for Windows, arm64 and macOS; run by Wine and qemu, or read
#   make bench     speed against accuracy
#   make bench-pairs BEFORE=COMMIT  whether a row of it is slower than that commit's
#   make bench-frames BEFORE=COMMIT  whether a frame of an example scene takes longer than at that commit
#   make bench-povray  what a block costs a render of POV-Ray's
#   make compare-peers  the bumped plate in Cycles 3.4 and 5.0 and in Mitsuba 3, beside ours
#   make compare-files  scenes of others, from packages, in our engine and in Cycles
#   make compare-materials  materials of stock nodes, likewise
#   make pictures  the pictures of README.md, from a run of `make compare`
#   make fuzz      SECONDS=60 of fuzzing for each parser, with clang
#   make lint      layout of C, mistakes in Python and scripts, spelling, licences (.pre-commit-config.yaml)
#   make compile_commands.json  how each C file is compiled, for clangd and its like
#   make clean     remove build/
# On Debian 12 and 13 each of them installs first what it needs (setup/setup.mk); elsewhere it names what is missing.
B := build
MANUAL := $(B)/manual/html
JOBS ?= $(shell nproc)
# all processors, unless -j is given
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(JOBS)
endif
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.PHONY: all demo check bench blender povray compare compare-files pictures lint clean help
include setup/setup.mk
include libshade/libshade.mk
include blender_addon_c/blender.mk
include povray_patches/povray.mk
include compare/compare.mk
include farm/farm.mk

# Packages, POV-Ray, the add-on and the library with its C tests at once, then pytest: its closing line is the result.
# What goes to which worker, and when, is in conftest.py. `--durations` says what tests took, setup/timed.sh what
# steps of make cost. One worker more than processors: a small picture takes POV-Ray .01 s, and .67 of waiting.
check:
	$(MAKE) --output-sync=target check-before-pytest
	$(PY) -m pytest --numprocesses $$(( $(JOBS) + 1 )) --dist loadfile --no-loadscope-reorder --durations 20
.PHONY: check-before-pytest smoke
check-before-pytest: povray setup-test setup-demo all blender native $(MEASURED) lint $(CHECKS)
ifneq ($(filter check-before-pytest,$(MAKECMDGOALS)),)
lint: | $(S)/lint.packages
$(NATIVE)/test_stages $(NATIVE)/test_system $(TESTS) $(CHECKS): | $(S)/test.packages
# SMOKE=1: the zip of `make release-addon`, too, for its tests, and a Debian 13 for Blender 5.2; where these can't be had tests say so
ifneq ($(SMOKE),)
check-before-pytest: release-fetched debian13 smoke
smoke: blender native release-fetched
	@[ ! -e $(VENV_RELEASE)/done ] || [ ! -e $(RELEASE_SOURCES)/done ] || $(MAKE) --no-print-directory NEEDS= release-addon
endif
endif

pictures: compare
	$(PY) setup/pictures.py

# nodes of ours, what their sockets do, the cookbook of POV-Ray (ten minutes of a processor)
.PHONY: manual-pictures
manual-pictures: blender povray
	$(PY) setup/pictures.py manual

# the tables of a page of the manual, which a test holds to what the exporter reads
.PHONY: supported
supported:
	@$(PYTHON3) setup/supported.py

# warnings are errors: a page that nothing leads to, a link that leads nowhere. It shows what --help prints, and asks the Python module
.PHONY: manual
manual: $(MANUAL)/index.html
$(MANUAL)/index.html: $(VENV_MANUAL)/done $(shell find docs -type f) $(SHADE_HELP) $(B)/help/farm.txt $(B)/$(SHADE_SHARED) \
  $(wildcard $(L)/python/shade/*.py $(L)/include/shade/*.h examples/*.jpg examples/nodes/*.png)
	$(call say,manual   ,$@)
	$(Q)rm -rf $(B)/manual
	$(Q)$(VENV_MANUAL)/bin/sphinx-build -q -W --keep-going -b html -d $(B)/manual/doctrees docs $(@D)
	@touch $@

# without git, as from an archive, what needs no list of files
lint: $(VENV_LINT)/done
	@if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then \
	  PRE_COMMIT_HOME=$(abspath $(B))/pre-commit $(VENV_LINT)/bin/pre-commit run --all-files --show-diff-on-failure; \
	else setup/lint.sh; fi

# what make would run, made nothing of: each line that compiles
.PHONY: compile_commands.json
compile_commands.json:
	@$(MAKE) -nB -j1 --no-print-directory NEEDS= V=1 all native 2>/dev/null | $(PYTHON3) setup/compile_commands.py >$@.part
	@mv $@.part $@

clean:
	rm -rf $(B) compile_commands.json

help:
	@sed -n 's/^#   make/make/p' Makefile
