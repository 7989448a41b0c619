# SPDX-License-Identifier: Apache-2.0
# `make macos`: libshade and shade for macOS 13 and later, on arm64 and on x86-64, as the zig of `make release` compiles and
# on arm64 signs them (without a name: ad hoc): build/release/libshade-VERSION-macos-arm64.tar.gz and -macos-x64.tar.gz.
# The renderer's part is in blender_addon_c/macos.mk. Nothing here can run what it makes: tests read it.
MACHINES := arm64 x64
# the one of them that a make is for: make macos-one MACOS=x64
MACOS := arm64
MACOS_CPU_arm64 := aarch64
MACOS_CPU_x64 := x86_64
M := $(B)/macos/$(MACOS)
MACOS_CC = $(ZIG) cc -target $(MACOS_CPU_$(MACOS))-macos.13.0
MACOS_AR = $(ZIG) ar
# of LLVM, where its packages have them
LLVM = $(shell llvm-config --bindir)
.PHONY: macos macos-one macos-built
macos:
	$(Q)+for machine in $(MACHINES); do $(MAKE) --no-print-directory NEEDS= MACOS=$$machine macos-one || exit 1; done
	$(Q)$(SUMS)

# What others wrote, each as one archive, from the sources that `make windows` has too
MACOS_LIBS := $(patsubst %,$(M)/lib/lib%.a,z png16 OpenEXRCore)
$(M)/lib/libz.a: FROM = $(wildcard $(WINDOWS_SOURCES)/zlib-*/*.c)
$(M)/lib/libpng16.a: FROM = $(filter-out %/pngtest.c %/example.c,$(wildcard $(WINDOWS_SOURCES)/libpng1.6-*/*.c))
$(M)/lib/libOpenEXRCore.a: FROM = $(wildcard $(WINDOWS_SOURCES)/openexr-*/src/lib/OpenEXRCore/*.c)
# not that Mac that these two took for it, before there was a macOS
$(M)/lib/libz.a: FLAGS = -UTARGET_OS_MAC -DHAVE_UNISTD_H
$(M)/lib/libpng16.a: FLAGS = -UTARGET_OS_MAC -DPNG_ARM_NEON_OPT=0
$(M)/lib/libOpenEXRCore.a: FLAGS = $(EXR_CFLAGS)
$(MACOS_LIBS): $(M)/lib/lib%.a: $(WINDOWS_SOURCES)/done $(L)/macos.mk
	$(call say,compile  ,$@)
	$(Q)rm -rf $(M)/obj/$* $@ && mkdir -p $(@D) $(M)/obj/$* $(M)/include
	$(Q)cp $(WINDOWS_SOURCES)/libpng1.6-*/png.h $(WINDOWS_SOURCES)/libpng1.6-*/pngconf.h $(WINDOWS_SOURCES)/zlib-*/zlib.h \
	  $(WINDOWS_SOURCES)/zlib-*/zconf.h $(M)/include
	$(Q)cp $(WINDOWS_SOURCES)/libpng1.6-*/scripts/pnglibconf.h.prebuilt $(M)/include/pnglibconf.h
	$(Q)for source in $(FROM); do \
	  $(MACOS_CC) -O2 -w -fvisibility=hidden "-ffile-prefix-map=$(CURDIR)=." -I$(M)/include $(FLAGS) -c $$source -o $(M)/obj/$*/$$(basename $$source).o || exit 1; done
	$(Q)$(MACOS_AR) rcsD $@ $(M)/obj/$*/*.o

# of what its clang adds to that of Debian, nothing
MACOS_WARN := -Wall -Wextra -Wno-pass-failed -Wno-uninitialized-const-pointer -Wno-enum-float-conversion -Wno-enum-enum-conversion
# zig takes the names of processors for those of its own, and -mtune for what to make code for
MACOS_MAKE = $(MAKE) --no-print-directory NEEDS= B=$(M) CC="$(MACOS_CC)" AR="$(MACOS_AR)" DEBUG= DEBUG_TYPES= LDFLAGS="-Wl,-s" \
  SHADE_WARN="$(MACOS_WARN)" \
  ISA_avx2="\$$(FULL_VECTORS) -mavx2 -mfma" ISA_avx512="\$$(FULL_VECTORS) -march=x86_64_v4 -mprefer-vector-width=512" \
  OIIO_LIBS= OIIO_MODULE= EXR_CFLAGS="$(filter -I%,$(EXR_CFLAGS))" EXR_LIBS="-L$(M)/lib -lOpenEXRCore -lz" \
  PNG_CFLAGS=-I$(M)/include PNG_LIBS="-L$(M)/lib -lpng16 -lz"
MACOS_DYLIB := libshade.$(basename $(SHADE_VERSION)).dylib
macos-built: $(MACOS_LIBS)
	$(Q)+$(MACOS_MAKE) $(M)/shade $(M)/$(MACOS_DYLIB)

MACOS_NAME := libshade-$(SHADE_VERSION)-macos-$(MACOS)
MACOS_ARCHIVE := $(B)/release/$(MACOS_NAME).tar.gz
MACOS_LICENCES := $(WINDOWS_SOURCES)/libpng1.6-*/LICENSE $(WINDOWS_SOURCES)/openexr-*/LICENSE.md $(WINDOWS_SOURCES)/zlib-*/LICENSE
MACOS_STAGE := $(M)/$(MACOS_NAME)
macos-one: $(MACOS_ARCHIVE)
$(MACOS_ARCHIVE): macos-built $(INSTALLED_HEADERS) $(L)/macos.mk $(CMAKE_PACKAGE:%=$(L)/cmake/%.in)
	$(call say,archive  ,$@)
	$(Q)rm -rf $(MACOS_STAGE) && mkdir -p $(addprefix $(MACOS_STAGE)/,bin licences)
	$(Q)cp $(M)/shade $(MACOS_STAGE)/bin
	$(call stage_library,$(MACOS_STAGE),$(MACOS_DYLIB),IMPORTED_SONAME "@rpath/$(MACOS_DYLIB)")
	$(Q)cp $(M)/libshade.a $(M)/$(MACOS_DYLIB) $(MACOS_STAGE)/lib
	$(Q)$(call stage_licences,$(MACOS_LICENCES),$(MACOS_STAGE))
	$(Q)$(call tar_of,$(MACOS_STAGE))

.PHONY: check-macos
check-macos: macos $(VENV)/done
	@BOTH=1 $(PY) -m pytest -q blender_addon_c/tests/test_macos.py
soak-machines: check-macos
