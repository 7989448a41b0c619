# SPDX-License-Identifier: Apache-2.0
# `make check-arm64`: library, tool and shade-render for Linux on arm64, whose instruction set is neon, as Debian's cross
# compiler makes them, and those of their tests that qemu, which is slow, has done in minutes. Part of `make soak-machines`.
ARM64 := $(B)/arm64
# of Debian for arm64, as what they are linked with
ARM64_LIBRARIES := $(ARM64)/debian
ARM64_FOLDERS := $(abspath $(ARM64_LIBRARIES))/usr/lib/aarch64-linux-gnu $(abspath $(ARM64_LIBRARIES))/lib/aarch64-linux-gnu
ARM64_CC := aarch64-linux-gnu-gcc $(ARM64_FOLDERS:%=-B%/) $(ARM64_FOLDERS:%=-Wl,-rpath-link,%)
ARM64_RUN := qemu-aarch64 -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH=$(subst $() ,:,$(ARM64_FOLDERS))
ARM64_MAKE = $(MAKE) --no-print-directory NEEDS= B=$(ARM64) CC="$(ARM64_CC)" AR=aarch64-linux-gnu-ar OIIO_LIBS= OIIO_MODULE= \
  CMOCKA_LIBS="-I$(W)/include -L$(ARM64)/lib -lcmocka" RUN="$(ARM64_RUN)"
$(ARM64_LIBRARIES)/done: setup/arm64-libraries.sh | $(S)/arm64.packages
	@setup/arm64-libraries.sh $(@D)
	@touch $@

ARM64_TESTS := bsdf_hit corpus fabric_nodes fabric_place fresnel isa json lanes leaves leaves_float params port rows split status swatch \
  tangents threads values weave weave_batch wif
# these by a part of their cases, as sanitizers have them
ARM64_SHORT := accuracy hostile pdf sample
$(ARM64)/lib/libcmocka.a: $(WINDOWS_SOURCES)/done $(W)/lib/libcmocka.a
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(ARM64_CC) -O2 -w -I$(wildcard $(WINDOWS_SOURCES)/cmocka-*/include) -DHAVE_STDLIB_H=1 -DHAVE_STRING_H=1 -DHAVE_STDINT_H=1 -DHAVE_INTTYPES_H=1 -DHAVE_UNISTD_H=1 \
	  -DHAVE_MALLOC_H=1 -DHAVE_SIGNAL_H=1 -DHAVE_STRINGS_H=1 -DHAVE_GCC_THREAD_LOCAL_STORAGE=1 -DHAVE_SIGLONGJMP=1 -D_GNU_SOURCE \
	  -c $(WINDOWS_SOURCES)/cmocka-*/src/cmocka.c -o $(@D)/cmocka.o && aarch64-linux-gnu-ar rcsD $@ $(@D)/cmocka.o
.PHONY: check-arm64
check-arm64: $(ARM64)/lib/libcmocka.a $(ARM64_LIBRARIES)/done blender $(RENDER)
	$(Q)+$(ARM64_MAKE) $(ARM64)/shade $(ARM64_TESTS:%=$(ARM64)/test/%.run)
	$(Q)+$(ARM64_MAKE) CFLAGS=-DSANITIZED $(ARM64_SHORT:%=$(ARM64)/test/%.run)
	$(Q)+$(ARM64_MAKE) $(ARM64)/shade-render $(ARM64)/blender/native/test_stages
	$(Q)$(ARM64_RUN) $(ARM64)/blender/native/test_stages
	@BOTH=1 $(PY) -m pytest -q blender_addon_c/tests/test_arm64_render.py
	$(Q)$(ARM64_RUN) $(ARM64)/shade --version | grep -q neon
soak-machines: check-arm64

# Library, tool and shade-render for others' machines, as linux.mk and blender_addon_c/release.mk say
.PHONY: linux-arm64
linux-arm64: $(ARM64_LIBRARIES)/done $(RELEASE_NEEDS)
	$(Q)+$(ARM64_MAKE) ARM64_LIBRARIES=$(ARM64_LIBRARIES) VENV_RELEASE=$(VENV_RELEASE) RELEASE_SOURCES=$(RELEASE_SOURCES) ZIG="$(ZIG)" ARCHIVES=$(B)/release \
	  STRIP=aarch64-linux-gnu-strip LD=aarch64-linux-gnu-ld linux
