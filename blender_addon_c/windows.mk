# SPDX-License-Identifier: GPL-3.0-or-later
# The renderer's part of `make windows` (libshade/windows.mk): build/release/shade-render-VERSION-windows-x64.zip, and the add-on,
# libshade-blender-VERSION-windows-x64.zip. Embree, its TBB and the C++ runtime that both need are those of wheels, under names
# that nothing else in a process has.
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
	$(Q)$(call stage_licences,$(WINDOWS_RENDER_LICENCES),$(WINDOWS_RENDER_STAGE))
	$(Q)for wheel in embreex msvc_runtime; do \
	  cp $(WINDOWS_WHEELS)/$$wheel-*.dist-info/licenses/LICENSE $(WINDOWS_RENDER_STAGE)/licences/$$wheel.txt || exit 1; done
	$(Q)cp LICENSES/Apache-2.0.txt $(WINDOWS_RENDER_STAGE)/licences/libtbb.txt
	$(Q)$(PYTHON3) blender_addon_c/package.py $@ $(WINDOWS_RENDER_STAGE) $$(find $(WINDOWS_RENDER_STAGE) -type f)

# The add-on. Python's headers are the system's, but for what they ask of Windows; what the module takes of Python it takes by
# name from python3.dll, which each of its versions has
WINDOWS_PYTHON_OBJ := $(patsubst $(N)/%.c,$(W)/blender/native/obj/%.o,$(wildcard $(N)/python/*.c))
WINDOWS_MAKE += NATIVE_PYTHON_CFLAGS="-isystem $(W)/python" NATIVE_PYTHON_LIBS="-L$(W)/lib -lpython3"
$(W)/python/pyconfig.h: blender_addon_c/windows_pyconfig.h | $(S)/blender.packages
	$(Q)rm -rf $(@D) && mkdir -p $(W)
	$(Q)cp -rL "$$($(NATIVE_PYTHON) -c "import sysconfig as s; print(s.get_path('include'))")" $(@D)
	$(Q)cp $< $@
$(W)/lib/libshade_openexrcore.dll: $(W)/lib/libOpenEXRCore.a
	$(call say,link     ,$@)
	$(Q)$(WINDOWS_CC) -shared -static -s -Wl,--no-insert-timestamp -Wl,--whole-archive $< -Wl,--no-whole-archive -lz -o $@
# Python 3.10 of Blender 3.4 to 4.0, whose python3.dll lacks what 3.11 made part of its stable ABI: by the DLL of that version alone
WINDOWS_310 := $(W)/python310/_native.cp310-win_amd64.pyd
WINDOWS_ADDON := $(W)/addon/libshade
WINDOWS_ADDON_ZIP := $(B)/release/libshade-blender-$(SHADE_VERSION)-windows-x64.zip
.PHONY: windows-addon-built
windows: $(WINDOWS_ADDON_ZIP)
windows-addon-built: windows-render-built $(W)/python/pyconfig.h
	$(Q)+$(WINDOWS_MAKE) --silent $(WINDOWS_PYTHON_OBJ)
	@for python in python3 python310; do \
	  { echo "LIBRARY $$python.dll"; echo EXPORTS; x86_64-w64-mingw32-nm -u $(WINDOWS_PYTHON_OBJ) | \
	    sed -n 's/^ *U __imp_\(_*Py.*\)/  \1/p' | LC_ALL=C sort -u; } >$(W)/lib/$$python.def.part; \
	  cmp -s $(W)/lib/$$python.def.part $(W)/lib/$$python.def || { mv $(W)/lib/$$python.def.part $(W)/lib/$$python.def && \
	    x86_64-w64-mingw32-dlltool -d $(W)/lib/$$python.def -l $(W)/lib/lib$$python.a; } || exit 1; done
	$(Q)+$(WINDOWS_MAKE) $(W)/blender/native/_native.pyd
	@mkdir -p $(dir $(WINDOWS_310))
	$(Q)+$(WINDOWS_MAKE) NATIVE_SO=$(WINDOWS_310) NATIVE_PYTHON_LIBS="-L$(W)/lib -lpython310" $(WINDOWS_310)
$(WINDOWS_ADDON_ZIP): windows-addon-built $(W)/lib/libshade_openexrcore.dll $(BLENDER_ZIPPED) blender_addon_c/windows.mk
	$(call say,zip      ,$@)
	$(Q)rm -rf $(WINDOWS_ADDON) && mkdir -p $(@D) $(WINDOWS_ADDON)/lib
	$(Q)cd $(BLENDER_ADDON) && cp --parents -r $(patsubst $(BLENDER_ADDON)/%,%,$(filter-out $(BLENDER_NATIVE) $(BLENDER_MANUAL),$(BLENDER_ZIPPED))) \
	  manual $(abspath $(WINDOWS_ADDON))
	$(Q)cp $(W)/blender/native/_native.pyd $(WINDOWS_ADDON)
	$(Q)cp $(WINDOWS_RUNTIME) $(W)/lib/libshade_openexrcore.dll $(WINDOWS_ADDON)/lib
	$(Q)sed -i 's/^platforms = .*/platforms = ["windows-x64"]/' $(WINDOWS_ADDON)/blender_manifest.toml
	$(Q)$(PYTHON3) blender_addon_c/package.py $@ $(WINDOWS_ADDON) $$(find $(WINDOWS_ADDON) -type f)

# For Blender 3.4 to 4.1, which take add-ons for all systems alike: Linux and Windows in one zip
FLAT_ADDON := $(W)/flat/libshade
FLAT_ZIP := $(B)/release/libshade-blender-$(SHADE_VERSION)-3.4-to-4.1.zip
.PHONY: release-flat
release: release-flat
release-flat: $(FLAT_ZIP)
$(FLAT_ZIP): $(WINDOWS_ADDON_ZIP) $(RELEASE_ZIP) blender_addon_c/windows.mk
	$(call say,zip      ,$@)
	$(Q)rm -rf $(FLAT_ADDON) && mkdir -p $(FLAT_ADDON)
	$(Q)cp -r $(RELEASE_ADDON)/. $(FLAT_ADDON) && cp -r $(WINDOWS_ADDON)/. $(WINDOWS_310) $(FLAT_ADDON)
	$(Q)sed -i 's/^platforms = .*/platforms = ["linux-x64", "windows-x64"]/' $(FLAT_ADDON)/blender_manifest.toml
	$(Q)$(PYTHON3) blender_addon_c/package.py $@ $(FLAT_ADDON) $$(find $(FLAT_ADDON) -type f)

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
check-door-render: $(W)/system.exe
	$(Q)$(WINE_RUN) $< 2>&1
	$(Q)+$(WINDOWS_MAKE) B=$(B)/windows-warnings CFLAGS=-fsyntax-only native-read
endif
$(W)/system.exe: blender_addon_c/tests/test_system.c $(wildcard $(N)/system/*.[ch]) $(L)/port/threads.c $(W)/lib/libcmocka.a
	$(call say,compile  ,$@)
	$(Q)$(WINDOWS_CC) -O1 -std=c11 -Wall -Wextra -Wconversion -Wno-format $(WERROR) -D_POSIX_C_SOURCE=200809L -D__USE_MINGW_ANSI_STDIO=1 \
	  -I$(W)/include -I$(N) -I$(L) $(filter %.c,$^) $(NATIVE_WRAP) -L$(W)/lib -lcmocka -pthread -static -o $@
