# SPDX-License-Identifier: Apache-2.0
# `make windows`: libshade and shade for Windows on x86-64, as Debian's mingw-w64 compiles them:
# build/release/libshade-VERSION-windows-x64.zip. Nothing of theirs is a DLL but libshade itself.
# The renderer's part is in blender_addon_c/windows.mk.
# `make check-windows` runs their tests by Wine, or says that there is none.
W := $(B)/windows
WINDOWS_CC := x86_64-w64-mingw32-gcc-posix
WINDOWS_AR := x86_64-w64-mingw32-ar
WINDOWS_STRIP := x86_64-w64-mingw32-strip
WINDOWS_SOURCES := $(W)/debian
WINDOWS_NAME := libshade-$(SHADE_VERSION)-windows-x64
WINDOWS_ZIP := $(B)/release/$(WINDOWS_NAME).zip
WINE := /usr/lib/wine/wine64
# no desktop, no Mono and no Gecko: these would be asked for when its folder is made
WINE_RUN = WINEPREFIX=$(abspath $(W))/wine WINEDEBUG=-all WINEDLLOVERRIDES=mscoree,mshtml,winemenubuilder.exe= $(WINE)

$(WINDOWS_SOURCES)/done: setup/windows-sources.sh | $(S)/release.packages
	@setup/windows-sources.sh $(@D)
	@touch $@

# Pictures and dumps: what others wrote, each as one archive. Headers that OpenEXR's own build would make are the system's
WINDOWS_LIBS := $(patsubst %,$(W)/lib/lib%.a,png16 OpenEXRCore cmocka)
$(W)/lib/libpng16.a: FROM = $(filter-out %/pngtest.c %/example.c,$(wildcard $(WINDOWS_SOURCES)/libpng1.6-*/*.c))
$(W)/lib/libOpenEXRCore.a: FROM = $(wildcard $(WINDOWS_SOURCES)/openexr-*/src/lib/OpenEXRCore/*.c)
$(W)/lib/libcmocka.a: FROM = $(wildcard $(WINDOWS_SOURCES)/cmocka-*/src/cmocka.c)
$(W)/lib/libpng16.a: FLAGS = -I$(W)/include
$(W)/lib/libOpenEXRCore.a: FLAGS = $(EXR_CFLAGS)
$(W)/lib/libcmocka.a: FLAGS = -I$(wildcard $(WINDOWS_SOURCES)/cmocka-*/include) -DHAVE_STDLIB_H=1 -DHAVE_STRING_H=1 -DHAVE_STDINT_H=1 \
  -DHAVE_INTTYPES_H=1 -DHAVE_MALLOC_H=1 -DHAVE_SIGNAL_H=1 -DHAVE_TIME_H=1 -DHAVE_IO_H=1 -DHAVE_GCC_THREAD_LOCAL_STORAGE=1 -D__USE_MINGW_ANSI_STDIO=1
$(WINDOWS_LIBS): $(W)/lib/lib%.a: $(WINDOWS_SOURCES)/done $(L)/windows.mk
	$(call say,compile  ,$@)
	$(Q)rm -rf $(W)/obj/$* $@ && mkdir -p $(@D) $(W)/obj/$* $(W)/include
	$(Q)cp $(WINDOWS_SOURCES)/libpng1.6-*/png.h $(WINDOWS_SOURCES)/libpng1.6-*/pngconf.h $(WINDOWS_SOURCES)/cmocka-*/include/cmocka.h $(W)/include
	$(Q)cp $(WINDOWS_SOURCES)/libpng1.6-*/scripts/pnglibconf.h.prebuilt $(W)/include/pnglibconf.h
	$(Q)for source in $(FROM); do \
	  $(WINDOWS_CC) -O2 -w "-ffile-prefix-map=$(CURDIR)=." $(FLAGS) -c $$source -o $(W)/obj/$*/$$(basename $$source).o || exit 1; done
	$(Q)$(WINDOWS_AR) rcsD $@ $(W)/obj/$*/*.o

# no moment in what is linked: the same sources are the same bytes
WINDOWS_MAKE = $(MAKE) --no-print-directory NEEDS= B=$(W) CC="$(WINDOWS_CC)" AR=$(WINDOWS_AR) LDFLAGS="-s -Wl,--no-insert-timestamp" \
  OIIO_LIBS= OIIO_MODULE= EXR_CFLAGS="$(filter -I%,$(EXR_CFLAGS))" EXR_LIBS="-L$(W)/lib -lOpenEXRCore -lz" \
  PNG_CFLAGS=-I$(W)/include PNG_LIBS="-L$(W)/lib -lpng16 -lz" \
  CMOCKA_LIBS="-I$(W)/include -Wno-format -Wno-format-extra-args -L$(W)/lib -lcmocka" RUN="$(WINE_RUN)"
WINDOWS_DLL := libshade-$(basename $(SHADE_VERSION)).dll
.PHONY: windows windows-built
windows: $(WINDOWS_ZIP)
	$(Q)$(SUMS)
windows-built: $(WINDOWS_LIBS)
	$(Q)+$(WINDOWS_MAKE) $(W)/shade.exe $(W)/$(WINDOWS_DLL)

# programs in bin, with the DLL beside them
WINDOWS_STAGE := $(W)/$(WINDOWS_NAME)
# of what is linked into shade.exe; winpthreads' is in that of mingw-w64
WINDOWS_LICENCES := $(WINDOWS_SOURCES)/libpng1.6-*/LICENSE $(WINDOWS_SOURCES)/openexr-*/LICENSE.md \
  /usr/share/doc/libz-mingw-w64-dev/copyright /usr/share/doc/mingw-w64-common/copyright /usr/share/doc/gcc-mingw-w64-base/copyright
$(WINDOWS_ZIP): windows-built $(INSTALLED_HEADERS) $(L)/windows.mk $(CMAKE_PACKAGE:%=$(L)/cmake/%.in)
	$(call say,zip      ,$@)
	$(Q)rm -rf $(WINDOWS_STAGE) && mkdir -p $(@D) $(addprefix $(WINDOWS_STAGE)/,bin licences)
	$(Q)cp $(W)/shade.exe $(W)/$(WINDOWS_DLL) $(WINDOWS_STAGE)/bin
	$(call stage_library,$(WINDOWS_STAGE),../bin/$(WINDOWS_DLL),IMPORTED_IMPLIB "$${_libshade_lib}/libshade.dll.a")
	$(Q)cp $(W)/libshade.a $(W)/libshade.dll.a $(W)/libshade.def $(WINDOWS_STAGE)/lib
	$(Q)$(WINDOWS_STRIP) --strip-debug --enable-deterministic-archives $(WINDOWS_STAGE)/lib/libshade.a
	$(Q)$(call stage_licences,$(WINDOWS_LICENCES),$(WINDOWS_STAGE))
	$(Q)$(PYTHON3) blender_addon_c/package.py $@ $(WINDOWS_STAGE) $$(find $(WINDOWS_STAGE) -type f)

# All of the library's tests but those of signals and of stacks, which are POSIX's own; then those of programs
WINDOWS_TESTS := $(filter-out soak stack,$(TESTS:$(B)/test/%=%))
.PHONY: check-windows soak-machines
check-windows: windows $(VENV)/done
	$(Q)+$(WINDOWS_MAKE) $(WINDOWS_TESTS:%=$(W)/test/%.exe.run)
	@BOTH=1 $(PY) -m pytest -q $(WINDOWS_PYTEST)
WINDOWS_PYTEST := $(L)/test/test_windows.py
# `make soak-machines`: what is made here for other machines, run as they would
soak-machines: check-windows

# Of that `make check` takes what is cheap: all that Windows would compile, and the door to the system, which runs. Where
# there is no mingw-w64 or no Wine it says so (.ci/run fetches them)
WINDOWS_HERE = $(and $(shell command -v $(WINDOWS_CC)),$(wildcard $(WINE)),$(wildcard $(WINDOWS_SOURCES)/done))
.PHONY: check-door check-door-here windows-fetched
check-door: | $(if $(SMOKE),windows-fetched release-fetched)
	@$(MAKE) --no-print-directory NEEDS= check-door-here
ifneq ($(WINDOWS_HERE),)
check-door-here: $(W)/door.exe
	$(Q)$(WINE_RUN) $< 2>&1
	$(Q)+$(WINDOWS_MAKE) B=$(B)/windows-warnings CFLAGS="-fsyntax-only -I$(W)/include -Wno-format -Wno-format-extra-args" \
	  WARNED_TESTS="$(WINDOWS_TESTS:%=$(L)/test/test_%.c)" warnings
else
check-door-here:
	@echo "check: libshade for Windows is not looked at: make setup-windows"
endif
windows-fetched: | $(S)/demo.packages
	@$(MAKE) --no-print-directory NEEDS= $(S)/windows.packages $(WINDOWS_SOURCES)/done || \
	  echo "setup: what make windows needs can't be had: its tests are skipped" >&2
DOOR := $(wildcard $(L)/port/*.c) $(L)/dump/whole.c
$(W)/door.exe: $(L)/test/test_port.c $(DOOR) $(W)/lib/libcmocka.a $(wildcard $(L)/port/*.h $(L)/test/posix.h)
	$(call say,compile  ,$@)
	$(Q)$(WINDOWS_CC) -O1 -std=c11 -Wall -Wextra -Wconversion -Wno-float-conversion $(WERROR) -D__USE_MINGW_ANSI_STDIO=1 -I$(W)/include \
	  -I$(L)/include -I$(L) $< $(DOOR) -L$(W)/lib -lcmocka -pthread -static -o $@
