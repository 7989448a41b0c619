# SPDX-License-Identifier: GPL-3.0-or-later
# The renderer's part of `make windows` (libshade/windows.mk): build/release/shade-render-VERSION-windows-x64.zip. Embree, its
# TBB and the C++ runtime that both need are those of wheels, under names that nothing else in a process has.
WINDOWS_WHEELS := $(W)/wheels
$(WINDOWS_WHEELS)/done: setup/requirements-windows.txt $(VENV)/done
	@echo "setup: Embree for Windows into $(@D)"
	@rm -rf $(@D) && mkdir -p $(@D)
	@$(VENV)/bin/pip --disable-pip-version-check download --quiet --retries 5 --platform win_amd64 --python-version 3.11 \
	  --only-binary=:all: --no-deps --dest $(@D) -r $<
	@for wheel in $(@D)/*.whl; do $(PYTHON3) -m zipfile -e $$wheel $(@D) || exit 1; done
	@touch $@

WINDOWS_RUNTIME := $(patsubst %,$(W)/lib/%.dll,libshade_embree shtbb shcxx vcruntime140 vcruntime140_1)
# of one that exists when the recipe runs
WINDOWS_CXX = $(notdir $(wildcard $(WINDOWS_WHEELS)/embreex.libs/msvcp140*.dll))
$(W)/lib/libshade_embree.dll: FROM = $(WINDOWS_WHEELS)/embreex.libs/embree4.dll
$(W)/lib/libshade_embree.dll: NAMES = tbb12.dll=shtbb.dll $(WINDOWS_CXX)=shcxx.dll
$(W)/lib/shtbb.dll: FROM = $(WINDOWS_WHEELS)/embreex.libs/tbb12.dll
$(W)/lib/shtbb.dll: NAMES = $(WINDOWS_CXX)=shcxx.dll
$(W)/lib/shcxx.dll: FROM = $(WINDOWS_WHEELS)/embreex.libs/$(WINDOWS_CXX)
$(W)/lib/vcruntime140.dll $(W)/lib/vcruntime140_1.dll: FROM = $(WINDOWS_WHEELS)/msvc_runtime-*.data/data/Scripts/$(@F)
$(WINDOWS_RUNTIME): $(WINDOWS_WHEELS)/done setup/own_dll.py blender_addon_c/windows.mk
	@mkdir -p $(@D)
	$(call say,copy     ,$@)
	$(Q)$(PYTHON3) setup/own_dll.py $(FROM) $@ $(NAMES)

# Embree 4's headers are those that `make release` compiles with
WINDOWS_MAKE += NATIVE_EMBREE_CFLAGS="-isystem $(RELEASE_SOURCES)/embree/usr/include"
WINDOWS_STAGES := $(W)/blender/native/test_stages.exe
WINDOWS_RENDER_ZIP := $(B)/release/shade-render-$(SHADE_VERSION)-windows-x64.zip
WINDOWS_RENDER_STAGE := $(W)/$(basename $(notdir $(WINDOWS_RENDER_ZIP)))
.PHONY: windows-render-built
windows: $(WINDOWS_RENDER_ZIP)
windows-render-built: windows-built $(WINDOWS_RUNTIME) $(RELEASE_SOURCES)/done
	$(Q)+$(WINDOWS_MAKE) $(W)/shade-render.exe
# of what is linked into the program, and of what lies in its folder lib
WINDOWS_RENDER_LICENCES = $(WINDOWS_LICENCES) $(RELEASE_SOURCES)/embree/usr/share/doc/libembree-dev/copyright
$(WINDOWS_RENDER_ZIP): windows-render-built blender_addon_c/windows.mk
	$(call say,zip      ,$@)
	$(Q)rm -rf $(WINDOWS_RENDER_STAGE) && mkdir -p $(@D) $(WINDOWS_RENDER_STAGE)/lib $(WINDOWS_RENDER_STAGE)/licences
	$(Q)cp $(W)/shade-render.exe $(WINDOWS_RENDER_STAGE)
	$(Q)cp $(WINDOWS_RUNTIME) $(WINDOWS_RENDER_STAGE)/lib
	$(Q)cp LICENSES/GPL-3.0-or-later.txt $(WINDOWS_RENDER_STAGE)/LICENSE.txt
	$(Q)for file in $(WINDOWS_RENDER_LICENCES); do cp $$file $(WINDOWS_RENDER_STAGE)/licences/$$(basename $$(dirname $$file)).txt || exit 1; done
	$(Q)for wheel in embreex msvc_runtime; do \
	  cp $(WINDOWS_WHEELS)/$$wheel-*.dist-info/licenses/LICENSE $(WINDOWS_RENDER_STAGE)/licences/$$wheel.txt || exit 1; done
	$(Q)cp LICENSES/Apache-2.0.txt $(WINDOWS_RENDER_STAGE)/licences/libtbb.txt
	$(Q)$(PYTHON3) blender_addon_c/package.py $@ $(WINDOWS_RENDER_STAGE) $$(find $(WINDOWS_RENDER_STAGE) -type f)

# beside Linux's own, and scenes that Blender saves
.PHONY: check-windows-stages
check-windows: check-windows-stages blender $(RENDER)
check-windows-stages: windows-render-built
	$(Q)+$(WINDOWS_MAKE) $(WINDOWS_STAGES)
	@$(WINE_RUN) $(WINDOWS_STAGES)
WINDOWS_PYTEST += blender_addon_c/tests/test_windows_render.py

# what of it is cheap, in `make check`
ifneq ($(and $(WINDOWS_HERE),$(wildcard $(RELEASE_SOURCES)/done)),)
.PHONY: check-door-render
check-door-here: check-door-render
check-door-render:
	$(Q)+$(WINDOWS_MAKE) B=$(B)/windows-warnings CFLAGS=-fsyntax-only native-read
endif
