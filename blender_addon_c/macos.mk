# SPDX-License-Identifier: GPL-3.0-or-later
# The renderer's part of `make macos` (libshade/macos.mk): shade-render-VERSION-macos-arm64.tar.gz, and the add-on,
# libshade-blender-VERSION-macos-arm64.zip; the same for x64. Embree and TBB are those of wheels, under names that nothing else
# in a process has; the C++ runtime is macOS's own.
MACOS_WHEELS := $(B)/macos/wheels
$(MACOS_WHEELS)/done: setup/requirements-macos.txt $(VENV)/done
	@echo "setup: Embree for macOS into $(@D)"
	@rm -rf $(@D) && mkdir -p $(@D)
	@for cpu in arm64 x86_64; do $(VENV)/bin/pip --disable-pip-version-check download --quiet --retries 5 --platform macosx_13_0_$$cpu \
	  --python-version 3.11 --only-binary=:all: --no-deps --dest $(@D) -r $< && \
	  $(PYTHON3) -m zipfile -e $(@D)/*_$$cpu.whl $(@D)/$$cpu || exit 1; done
	@touch $@
MACOS_WHEEL_arm64 := $(MACOS_WHEELS)/arm64
MACOS_WHEEL_x64 := $(MACOS_WHEELS)/x86_64
MACOS_WHEEL = $(MACOS_WHEEL_$(MACOS))

# What LLVM changes it signs anew, by the name that the file has then. The wheel's TBB is for both processors, its name has a version
MACOS_RUNTIME := $(patsubst %,$(M)/own/libshade_%.dylib,embree tbb)
$(M)/own/libshade_embree.dylib: TAKE = cp $(MACOS_WHEEL)/embreex/.dylibs/libembree4.*.dylib
$(M)/own/libshade_tbb.dylib: TAKE = $(LLVM)/llvm-lipo -thin $(notdir $(MACOS_WHEEL)) $(MACOS_WHEEL)/embreex/.dylibs/libtbb.12*.dylib -output
$(MACOS_RUNTIME): $(MACOS_WHEELS)/done blender_addon_c/macos.mk
	@mkdir -p $(@D)/part
	$(call say,copy     ,$@)
	$(Q)$(TAKE) $(@D)/part/$(@F)
	$(Q)$(LLVM)/llvm-install-name-tool -id @loader_path/$(@F) \
	  -change @loader_path/$$(basename $(MACOS_WHEEL)/embreex/.dylibs/libtbb.12*.dylib) @loader_path/libshade_tbb.dylib $(@D)/part/$(@F)
	$(Q)mv $(@D)/part/$(@F) $@

# The renderer has the library in it, and shows nothing of it: the same objects, but for those that have public functions
MACOS_MODULE := $(M)/module
MACOS_MODULE_MAKE = $(MACOS_MAKE) B=$(MACOS_MODULE) PLAIN_B=$(M) PLAIN_ISAS="$(MACOS_ISAS_$(MACOS))" CFLAGS=-DSHADE_API= \
  NATIVE_EMBREE_CFLAGS="-isystem $(RELEASE_SOURCES)/embree/usr/include" NATIVE_PYTHON_CFLAGS="-isystem $(M)/python" \
  NATIVE_PYTHON_LIBS="-Wl,-undefined,dynamic_lookup" OBJCOPY=$(LLVM)/llvm-objcopy
MACOS_ISAS_arm64 := scalar neon
MACOS_ISAS_x64 := scalar sse2 avx2 avx512
MACOS_RENDER_NAME := shade-render-$(SHADE_VERSION)-macos-$(MACOS)
MACOS_RENDER_ARCHIVE := $(B)/release/$(MACOS_RENDER_NAME).tar.gz
MACOS_RENDER_STAGE := $(M)/$(MACOS_RENDER_NAME)
.PHONY: macos-render-built
macos-one: $(MACOS_RENDER_ARCHIVE)
macos-render-built: macos-built $(MACOS_RUNTIME) $(RELEASE_SOURCES)/done $(M)/python/pyconfig.h
	$(Q)+$(MACOS_MODULE_MAKE) $(MACOS_MODULE)/shade-render $(MACOS_MODULE)/blender/native/_native.abi3.so
MACOS_RENDER_LICENCES = $(MACOS_LICENCES) $(RELEASE_SOURCES)/embree/usr/share/doc/libembree-dev/copyright
$(MACOS_RENDER_ARCHIVE): macos-render-built blender_addon_c/macos.mk
	$(call say,archive  ,$@)
	$(Q)rm -rf $(MACOS_RENDER_STAGE) && mkdir -p $(MACOS_RENDER_STAGE)/lib $(MACOS_RENDER_STAGE)/licences
	$(Q)cp $(MACOS_MODULE)/shade-render $(MACOS_RENDER_STAGE)
	$(Q)cp $(MACOS_RUNTIME) $(MACOS_RENDER_STAGE)/lib
	$(Q)cp LICENSES/GPL-3.0-or-later.txt $(MACOS_RENDER_STAGE)/LICENSE.txt
	$(Q)$(call stage_licences,$(MACOS_RENDER_LICENCES),$(MACOS_RENDER_STAGE))
	$(Q)cp $(MACOS_WHEEL)/embreex-*.dist-info/licenses/LICENSE $(MACOS_RENDER_STAGE)/licences/embreex.txt
	$(Q)cp LICENSES/Apache-2.0.txt $(MACOS_RENDER_STAGE)/licences/libtbb.txt
	$(Q)$(call tar_of,$(MACOS_RENDER_STAGE))

# The add-on. Python's headers are the system's, but for what they ask of macOS; what the module takes of Python is that of
# the process that loads it
$(M)/python/pyconfig.h: blender_addon_c/macos_pyconfig.h | $(S)/blender.packages
	$(Q)rm -rf $(@D) && mkdir -p $(M)
	$(Q)cp -rL "$$($(NATIVE_PYTHON) -c "import sysconfig as s; print(s.get_path('include'))")" $(@D)
	$(Q)cp $< $@
$(M)/own/libshade_openexrcore.dylib: $(M)/lib/libOpenEXRCore.a
	@mkdir -p $(@D)
	$(call say,link     ,$@)
	$(Q)$(MACOS_CC) -shared -Wl,-s -Wl,-install_name,@loader_path/$(@F) -Wl,-force_load,$< -L$(M)/lib -lz -o $@
MACOS_ADDON := $(M)/addon/libshade
MACOS_ADDON_ZIP := $(B)/release/libshade-blender-$(SHADE_VERSION)-macos-$(MACOS).zip
macos-one: $(MACOS_ADDON_ZIP)
macos: $(BLENDER_ZIPPED)
$(MACOS_ADDON_ZIP): macos-render-built $(M)/own/libshade_openexrcore.dylib $(BLENDER_ZIPPED) blender_addon_c/macos.mk
	$(call say,zip      ,$@)
	$(Q)rm -rf $(MACOS_ADDON) && mkdir -p $(@D) $(MACOS_ADDON)/lib
	$(Q)cd $(BLENDER_ADDON) && cp --parents -r $(patsubst $(BLENDER_ADDON)/%,%,$(filter-out $(BLENDER_NATIVE) $(BLENDER_MANUAL),$(BLENDER_ZIPPED))) \
	  manual $(abspath $(MACOS_ADDON))
	$(Q)cp $(MACOS_MODULE)/blender/native/_native.abi3.so $(MACOS_ADDON)
	$(Q)cp $(MACOS_RUNTIME) $(M)/own/libshade_openexrcore.dylib $(MACOS_ADDON)/lib
	$(Q)sed -i 's/^platforms = .*/platforms = ["macos-$(MACOS)"]/' $(MACOS_ADDON)/blender_manifest.toml
	$(Q)$(PYTHON3) blender_addon_c/package.py $@ $(MACOS_ADDON) $$(find $(MACOS_ADDON) -type f)

# Of that `make check` takes what is cheap: the door to the system, as macOS would compile it, where zig and the sources are there
ifneq ($(and $(wildcard $(VENV_RELEASE)/done),$(wildcard $(WINDOWS_SOURCES)/done)),)
check-door-here: check-door-macos
.PHONY: check-door-macos
check-door-macos: $(M)/door.stamp
$(M)/door.stamp: $(wildcard $(L)/port/*.[ch]) $(wildcard $(N)/system/*.[ch])
	@mkdir -p $(@D)
	$(call say,compile  ,the door to macOS)
	$(Q)for source in $(filter %.c,$^); do $(MACOS_CC) -std=c11 -Wconversion $(MACOS_WARN) $(WERROR) -D_POSIX_C_SOURCE=200809L -D_DARWIN_C_SOURCE \
	  -I$(L) -I$(N) -c $$source -o $(M)/door.o || exit 1; done
	@touch $@
endif
