# SPDX-License-Identifier: Apache-2.0
# What must be on the system: Debian packages and, in build/, Python environments with pinned packages.
#   make setup-build setup-blender setup-povray setup-package setup-demo setup-test setup-peers setup-release setup-windows setup-macos setup-arm64
# The system's own Python, once it is there. Wheels of bpy are each for one version of it: 3.11 on Debian 12, 3.13 on 13
PYTHON3 := /usr/bin/python3
PYTHON_VERSION = $(shell $(PYTHON3) -c 'import sys; print("%d.%d" % sys.version_info[:2])')
BPY_OF_3.11 := 5.0
BPY_OF_3.13 := 5.2
BPY_OF_IT = $(or $(BPY_OF_$(PYTHON_VERSION)),$(error PyPI has no bpy for Python $(PYTHON_VERSION)))
VENV := $(B)/venv
VENV_BPY := $(B)/venv-bpy
VENV_PEERS := $(B)/venv-peers
VENV_RELEASE := $(B)/venv-release
VENV_LINT := $(B)/venv-lint
VENV_MANUAL := $(B)/venv-manual
VENVS := $(VENV) $(VENV_BPY) $(VENV_PEERS) $(VENV_RELEASE) $(VENV_LINT) $(VENV_MANUAL) $(B)/venv-bpy-4.2 $(B)/venv-bpy-4.5
RELEASE_SOURCES := $(B)/release/debian
# with what it keeps in build/
ZIG = ZIG_GLOBAL_CACHE_DIR=$(abspath $(B))/release/zig ZIG_LOCAL_CACHE_DIR=$(abspath $(B))/release/zig $(abspath $(VENV_RELEASE))/bin/python -m ziglang
PY := $(VENV)/bin/python
PY_BPY := $(VENV_BPY)/bin/python
S := $(B)/setup

# Each goal's needs. The stamps are included as (empty) makefiles: make remakes those first and then
# starts over, so that tests such as "is OpenEXR here?" see the finished system.
NEEDS_blender := build blender
NEEDS_native := build blender test
NEEDS_render := build blender
NEEDS_native-sanitized := $(NEEDS_native)
NEEDS_check-sanitized := $(NEEDS_native)
NEEDS_povray := build povray
NEEDS_povray-package := $(NEEDS_povray) package
NEEDS_compare := build blender povray demo
NEEDS_demo := $(NEEDS_compare)
NEEDS_compare-peers := $(NEEDS_compare) peers
NEEDS_compare-quick := $(NEEDS_demo)
NEEDS_pictures := $(NEEDS_compare)
NEEDS_manual-pictures := $(NEEDS_compare) test
NEEDS_bench := build
NEEDS_bench-pairs := build
NEEDS_bench-frames := $(NEEDS_compare)
NEEDS_check-libshade := build test
NEEDS_soak := build blender povray package test release
NEEDS_check-povray-package := $(NEEDS_povray-package) test
NEEDS_check-povray-scenes := build povray test
NEEDS_lint := lint
NEEDS_release-addon := build blender release
NEEDS_release := build blender release windows macos arm64
NEEDS_windows := build blender windows
NEEDS_macos := build blender release macos
NEEDS_check-windows := build blender windows test
NEEDS_check-arm64 := build blender windows arm64 test
NEEDS_check-macos := $(NEEDS_macos) test
NEEDS_soak-machines := $(NEEDS_check-windows) $(NEEDS_macos) arm64
NEEDS_fuzz := build blender test
# what make must find when it starts; the rest is fetched and unpacked while these are compiled
NEEDS_check := build blender
NEEDS := $(sort $(foreach goal,$(MAKECMDGOALS),$(NEEDS_$(goal))))
ifneq ($(NEEDS),)
include $(NEEDS:%=$(S)/%.stamp)
endif

SETUPS := build blender povray package demo test lint peers release windows macos arm64
.PHONY: $(SETUPS:%=setup-%)
$(SETUPS:%=setup-%): setup-%: $(S)/%.stamp

.PRECIOUS: $(S)/%.packages
$(S)/%.packages: setup/packages-%.txt
	@mkdir -p $(@D)
	@setup/apt.sh $<
	@touch $@
$(S)/%.stamp: $(S)/%.packages
	@touch $@
ifneq ($(filter check-before-pytest,$(MAKECMDGOALS)),)
# one after the other: one that waits for another's apt would take the place of a compiler
$(S)/test.packages: | $(S)/povray.packages
$(S)/demo.packages $(S)/lint.packages: | $(S)/test.packages
endif
$(S)/demo.stamp: $(VENV)/done
$(S)/test.stamp: $(VENV)/done $(VENV_BPY)/done
$(S)/peers.stamp: $(VENV)/done $(VENV_BPY)/done $(VENV_PEERS)/done
$(S)/lint.stamp: $(VENV_LINT)/done
$(S)/windows.stamp: $(B)/windows/debian/done $(B)/windows/wheels/done $(RELEASE_SOURCES)/done
$(S)/macos.stamp: $(B)/windows/debian/done $(B)/macos/wheels/done $(VENV_RELEASE)/done $(RELEASE_SOURCES)/done
$(S)/release.stamp: $(VENV_RELEASE)/done $(RELEASE_SOURCES)/done

PINS = $<
$(VENV)/done: setup/requirements.txt
$(VENV_BPY)/done: $(wildcard setup/requirements-bpy-*.txt)
$(VENV_BPY)/done: PINS = setup/requirements-bpy-$(BPY_OF_IT).txt
$(VENV_PEERS)/done: setup/requirements-peers.txt
$(VENV_RELEASE)/done: setup/requirements-release.txt
$(VENV_LINT)/done: setup/requirements-lint.txt
$(VENV_MANUAL)/done: setup/requirements-manual.txt
# of two wheels a few files are wanted
$(VENV_RELEASE)/done: PIP_FLAGS := --no-deps --no-compile
# of 4.2 and 4.5 for make soak
$(B)/venv-bpy-4.2/done: setup/requirements-bpy-4.2.txt
$(B)/venv-bpy-4.5/done: setup/requirements-bpy-4.5.txt
$(VENVS:%=%/done): | $(S)/demo.packages
	@echo "setup: Python packages of $(PINS) into $(@D)"
	@rm -rf $(@D)
	@$(PYTHON3) -m venv $(@D)
	@$(@D)/bin/pip --disable-pip-version-check install --quiet --retries 5 $(PIP_FLAGS) -r $(PINS)
	@touch $@

$(RELEASE_SOURCES)/done: setup/release-sources.sh | $(S)/release.packages
	@setup/release-sources.sh $(@D)
	@touch $@

# A Debian 13 for bpy of other versions than this system's Python has, where it can be had
DEBIAN13_BPY = $(filter-out $(BPY_OF_$(PYTHON_VERSION)),5.2 $(if $(filter soak%,$(MAKECMDGOALS)),5.3))
.PHONY: debian13
debian13: $(VENV)/done
	@[ -z "$(DEBIAN13_BPY)" ] || setup/debian13.sh $(DEBIAN13_BPY)
# What `make release-addon` needs of others, where it can be had
.PHONY: release-fetched
release-fetched: | $(S)/demo.packages $(S)/release.packages
	@$(MAKE) --no-print-directory NEEDS= $(RELEASE_NEEDS) || \
	  echo "setup: what make release-addon needs can't be had: tests of its zip are skipped" >&2
