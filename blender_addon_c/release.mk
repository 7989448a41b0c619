# SPDX-License-Identifier: GPL-3.0-or-later
# The zip for every Linux with glibc 2.28 or later: build/release/libshade-blender.zip. The same objects as those of the
# local module, but for the one that knows Embree, linked to the symbols that glibc 2.28 has; Embree 4 and its TBB of
# PyPI's embreex; OpenEXRCore compiled here, with zlib in it.
RELEASE := $(B)/release
RELEASE_ADDON := $(RELEASE)/libshade
RELEASE_ZIP := $(RELEASE)/libshade-blender.zip
RELEASE_NATIVE := $(patsubst %,$(RELEASE_ADDON)/%,_native.abi3.so $(patsubst %,lib/libshade_%.so,embree tbb openexrcore))
RELEASE_FILES := $(RELEASE_NATIVE) $(patsubst $(BLENDER_ADDON)/%,$(RELEASE_ADDON)/%,$(filter-out $(BLENDER_NATIVE),$(BLENDER_ZIPPED)))
RELEASE_NEEDS := $(VENV_RELEASE)/done $(RELEASE_SOURCES)/done

# zig's own runtime answers __builtin_cpu_supports wrongly: gcc's comes first. No debug information: zig's names folders
RELEASE_LINK = ZIG_GLOBAL_CACHE_DIR=$(abspath $(RELEASE))/zig ZIG_LOCAL_CACHE_DIR=$(abspath $(RELEASE))/zig \
  $(abspath $(VENV_RELEASE))/bin/python -m ziglang cc -target x86_64-linux-gnu.2.28 -Wl,--strip-debug
RELEASE_RUNTIME = $(shell $(CC) -print-libgcc-file-name)

.PHONY: release
release: $(RELEASE_ZIP)

RELEASE_OBJ := $(filter-out %/scene/accel.o,$(NATIVE_OBJ)) $(RELEASE)/obj/accel.o
$(RELEASE)/obj/accel.o: NATIVE_FOR = -isystem $(RELEASE_SOURCES)/embree/usr/include
$(RELEASE)/obj/accel.o: $(N)/scene/accel.c $(NATIVE_FLAGS_IN) $(RELEASE_SOURCES)/done
	$(NATIVE_COMPILE)
-include $(wildcard $(RELEASE)/obj/accel.d)
$(RELEASE_ADDON)/_native.abi3.so: $(RELEASE_OBJ) $(NATIVE_ARCHIVES) $(NATIVE_EXPORTS) $(RELEASE_NEEDS) blender_addon_c/release.mk
	@mkdir -p $(@D)
	$(call say,link     ,$@)
	$(Q)$(RELEASE_LINK) $(NATIVE_LDFLAGS) $(RELEASE_OBJ) $(NATIVE_ARCHIVES) $(RELEASE_RUNTIME) -lm -lpthread -ldl -o $@

$(RELEASE_ADDON)/lib/libshade_embree.so: FROM = $(VENV_RELEASE)/lib/python3*/site-packages/embreex.libs/libembree4-*.so.4
$(RELEASE_ADDON)/lib/libshade_tbb.so: FROM = $(VENV_RELEASE)/lib/python3*/site-packages/embreex.libs/libtbb-*.so.12
$(RELEASE_ADDON)/lib/libshade_embree.so $(RELEASE_ADDON)/lib/libshade_tbb.so: $(VENV_RELEASE)/done blender_addon_c/native.mk
	$(NATIVE_OWN)

# two of its headers are made by its own build: those of the system's
RELEASE_EXR = $(RELEASE_SOURCES)/openexr-*/src/lib/OpenEXRCore
$(RELEASE)/openexrcore.o: $(RELEASE_SOURCES)/done blender_addon_c/release.mk
	$(call say,compile  ,$@)
	$(Q)mkdir -p $(RELEASE)/openexrcore
	$(Q)for source in $(RELEASE_EXR)/*.c; do $(CC) -O2 -fPIC -w $(EXR_CFLAGS) -I$$(dirname $$source) \
	  -c $$source -o $(RELEASE)/openexrcore/$$(basename $$source).o || exit 1; done
	$(Q)ld -r $(RELEASE)/openexrcore/*.o -o $@
$(RELEASE_ADDON)/lib/libshade_openexrcore.so: $(RELEASE)/openexrcore.o $(N)/system/openexrcore.map $(VENV_RELEASE)/done
	@mkdir -p $(@D)
	$(call say,link     ,$@)
	$(Q)$(RELEASE_LINK) -shared -Wl,-Bsymbolic -Wl,--version-script=$(N)/system/openexrcore.map -Wl,-soname,$(@F) \
	  $< $(shell $(CC) -print-file-name=libz.a) $(RELEASE_RUNTIME) -lm -lpthread -o $@

$(RELEASE_ADDON)/manual/index.html: $(BLENDER_MANUAL)
	$(Q)rm -rf $(@D) && mkdir -p $(dir $(@D)) && cp -r $(<D) $(@D)
$(RELEASE_ADDON)/%: $(BLENDER_ADDON)/%
	@mkdir -p $(@D)
	$(Q)cp $< $@
$(RELEASE_ZIP): blender_addon_c/package.py $(RELEASE_FILES)
	$(call say,zip      ,$@)
	$(Q)/usr/bin/python3 $< $@ $(RELEASE_ADDON) $(RELEASE_FILES) $(call rest_of_manual,$(RELEASE_ADDON))
