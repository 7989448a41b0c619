# SPDX-License-Identifier: Apache-2.0
# libshade and shade for every Linux with glibc 2.28 or later: libshade-VERSION-linux-x64.tar.gz, and -linux-arm64.tar.gz by a make
# for arm64 (arm64.mk). The objects of this build, linked by zig to the symbols that glibc 2.28 has; OpenEXRCore, libpng and zlib in
# the tool.
RELEASE := $(B)/release
# where archives go, of other machines too
ARCHIVES := $(RELEASE)
RELEASE_NEEDS := $(VENV_RELEASE)/done $(RELEASE_SOURCES)/done
LINUX_MACHINE := $(if $(TARGET_IS_ARM64),arm64,x64)
# zig's own runtime answers __builtin_cpu_supports wrongly: gcc's comes first. No debug information: zig's names folders
RELEASE_LINK = $(ZIG) cc -target $(if $(TARGET_IS_ARM64),aarch64,x86_64)-linux-gnu.2.28 -Wl,--strip-debug
RELEASE_RUNTIME = $(shell $(CC) -print-libgcc-file-name)
STRIP := strip
LD := ld

# two of its headers are made by its own build: those of the system's
RELEASE_EXR = $(RELEASE_SOURCES)/openexr-*/src/lib/OpenEXRCore
$(RELEASE)/openexrcore.o: $(RELEASE_SOURCES)/done $(L)/linux.mk
	$(call say,compile  ,$@)
	$(Q)mkdir -p $(RELEASE)/openexrcore
	$(Q)for source in $(RELEASE_EXR)/*.c; do $(CC) -O2 -fPIC -w $(EXR_CFLAGS) -I$$(dirname $$source) \
	  -c $$source -o $(RELEASE)/openexrcore/$$(basename $$source).o || exit 1; done
	$(Q)$(LD) -r $(RELEASE)/openexrcore/*.o -o $@
LINUX_STATIC = $(foreach name,png16 z,$(shell $(CC) -print-file-name=lib$(name).a))
LINUX_TOOL := $(RELEASE)/linux/shade
$(LINUX_TOOL): $(TOOL_OBJ) $(REF_OBJ) $(B)/libshade.a $(RELEASE)/openexrcore.o $(RELEASE_NEEDS)
	@mkdir -p $(@D)
	$(call say,link     ,$@)
	$(Q)$(RELEASE_LINK) $(filter %.o %.a,$^) $(LINUX_STATIC) $(RELEASE_RUNTIME) -lm -lpthread -ldl -o $@
$(RELEASE)/linux/$(SHADE_SHARED): $(SHADE_OBJ) $(RELEASE_NEEDS) | $(B)/libshade.map
	@mkdir -p $(@D)
	$(call say,link     ,$@)
	$(Q)$(RELEASE_LINK) -shared -Wl,-soname,$(SHADE_SONAME),--version-script=$(B)/libshade.map $(filter %.o,$^) $(RELEASE_RUNTIME) -lm -o $@

LINUX_NAME := libshade-$(SHADE_VERSION)-linux-$(LINUX_MACHINE)
LINUX_STAGE := $(RELEASE)/linux/$(LINUX_NAME)
LINUX_ARCHIVE := $(ARCHIVES)/$(LINUX_NAME).tar.gz
# of what is linked into the tool
LINUX_LICENCES = $(RELEASE_SOURCES)/openexr-*/LICENSE.md /usr/share/doc/zlib1g-dev/copyright /usr/share/doc/libpng-dev/copyright
.PHONY: linux
linux: $(LINUX_ARCHIVE)
$(LINUX_ARCHIVE): $(LINUX_TOOL) $(RELEASE)/linux/$(SHADE_SHARED) $(B)/libshade.a $(INSTALLED_HEADERS) $(L)/linux.mk $(CMAKE_PACKAGE:%=$(L)/cmake/%.in)
	$(call say,archive  ,$@)
	$(Q)rm -rf $(LINUX_STAGE) && mkdir -p $(addprefix $(LINUX_STAGE)/,bin licences)
	$(call stage_library,$(LINUX_STAGE),$(SHADE_SHARED),IMPORTED_SONAME "$(SHADE_SONAME)")
	$(Q)cp $(LINUX_TOOL) $(LINUX_STAGE)/bin
	$(Q)cp $(B)/libshade.a $(RELEASE)/linux/$(SHADE_SHARED) $(LINUX_STAGE)/lib
	$(Q)$(STRIP) --strip-debug --enable-deterministic-archives $(LINUX_STAGE)/lib/libshade.a
	$(Q)ln -s $(SHADE_SHARED) $(LINUX_STAGE)/lib/$(SHADE_SONAME) && ln -s $(SHADE_SHARED) $(LINUX_STAGE)/lib/libshade.so
	$(Q)$(call stage_licences,$(LINUX_LICENCES),$(LINUX_STAGE))
	$(Q)$(call tar_of,$(LINUX_STAGE))
