# SPDX-License-Identifier: GPL-3.0-or-later
# The zip for every Linux with glibc 2.28 or later: build/release/libshade-blender.zip. The same objects as those of the
# local module, but for the one that knows Embree, linked as libshade/linux.mk does; Embree 4 and its TBB of PyPI's embreex;
# OpenEXRCore compiled here, with zlib in it. `make release` makes all that others fetch, for each machine.
RELEASE_ADDON := $(RELEASE)/libshade
RELEASE_ZIP := $(RELEASE)/libshade-blender.zip
RELEASE_NATIVE := $(patsubst %,$(RELEASE_ADDON)/%,_native.abi3.so $(patsubst %,lib/libshade_%.so,embree tbb openexrcore))
RELEASE_FILES := $(RELEASE_NATIVE) $(patsubst $(BLENDER_ADDON)/%,$(RELEASE_ADDON)/%,$(filter-out $(BLENDER_NATIVE),$(BLENDER_ZIPPED)))

.PHONY: release release-addon
release-addon: $(RELEASE_ZIP)
release: release-addon linux linux-arm64 windows macos
	$(Q)$(SUMS)

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

# shade-render, with the same Embree in its folder lib; on arm64, which embreex has no wheel for, with that of Debian 12, for
# glibc 2.34 or later
LINUX_RENDER_NAME := shade-render-$(SHADE_VERSION)-linux-$(LINUX_MACHINE)
LINUX_RENDER_STAGE := $(RELEASE)/linux/$(LINUX_RENDER_NAME)
LINUX_RENDER_ARCHIVE := $(ARCHIVES)/$(LINUX_RENDER_NAME).tar.gz
LINUX_RENDER_LIBS := $(patsubst %,$(RELEASE_ADDON)/lib/libshade_%.so,embree tbb)
LINUX_RENDER_ACCEL := $(RELEASE)/obj/accel.o
LINUX_EMBREE_LICENCES = $(RELEASE_SOURCES)/embree/usr/share/doc/libembree-dev/copyright
ifdef TARGET_IS_ARM64
LINUX_RENDER_ACCEL := $(NATIVE)/obj/scene/accel.o
$(RELEASE_ADDON)/lib/libshade_embree.so: FROM = $(call NATIVE_SYSTEM,libembree3.so.3)
$(RELEASE_ADDON)/lib/libshade_tbb.so: FROM = $(call NATIVE_SYSTEM,libtbb.so.12)
LINUX_EMBREE_LICENCES = $(ARM64_LIBRARIES)/usr/share/doc/libembree3-3/copyright
endif
linux: $(LINUX_RENDER_ARCHIVE)
$(RELEASE)/linux/shade-render: $(filter-out %/scene/accel.o,$(RENDER_OBJ)) $(LINUX_RENDER_ACCEL) $(RELEASE)/openexrcore.o $(RELEASE_NEEDS)
	@mkdir -p $(@D)
	$(call say,link     ,$@)
	$(Q)$(RELEASE_LINK) $(NATIVE_WRAP) $(filter %.o %.a,$^) $(LINUX_STATIC) $(RELEASE_RUNTIME) -lm -lpthread -ldl -o $@
$(LINUX_RENDER_ARCHIVE): $(RELEASE)/linux/shade-render $(LINUX_RENDER_LIBS) blender_addon_c/release.mk
	$(call say,archive  ,$@)
	$(Q)rm -rf $(LINUX_RENDER_STAGE) && mkdir -p $(LINUX_RENDER_STAGE)/lib $(LINUX_RENDER_STAGE)/licences
	$(Q)cp $(RELEASE)/linux/shade-render $(LINUX_RENDER_STAGE)
	$(Q)cp $(LINUX_RENDER_LIBS) $(LINUX_RENDER_STAGE)/lib
	$(Q)cp LICENSES/GPL-3.0-or-later.txt $(LINUX_RENDER_STAGE)/LICENSE.txt
	$(Q)$(call stage_licences,$(LINUX_LICENCES) $(LINUX_EMBREE_LICENCES),$(LINUX_RENDER_STAGE))
	$(Q)$(if $(TARGET_IS_ARM64),,cp $(VENV_RELEASE)/lib/python3*/site-packages/embreex-*.dist-info/licenses/LICENSE $(LINUX_RENDER_STAGE)/licences/embreex.txt)
	$(Q)cp LICENSES/Apache-2.0.txt $(LINUX_RENDER_STAGE)/licences/libtbb.txt
	$(Q)$(call tar_of,$(LINUX_RENDER_STAGE))
