# SPDX-License-Identifier: Apache-2.0
# The shared library, `make install` and `make uninstall`. Both take the usual directories:
#   PREFIX BINDIR LIBDIR LIBEXECDIR INCLUDEDIR MANDIR PKGCONFIGDIR CMAKEDIR PYTHONDIR, and DESTDIR,
#   put before all of them.
# Paths must hold no spaces.
PREFIX ?= /usr/local
BINDIR ?= $(PREFIX)/bin
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
MANDIR ?= $(PREFIX)/share/man
PKGCONFIGDIR ?= $(LIBDIR)/pkgconfig
CMAKEDIR ?= $(LIBDIR)/cmake/libshade
LIBEXECDIR ?= $(PREFIX)/libexec
INSTALL ?= install
# where the system's Python looks for modules below PREFIX; where it looks nowhere there, a place to
# name in PYTHONPATH
PYTHON_LOOKS = import site, sys; \
  print(next((p for p in site.getsitepackages() if p.startswith(sys.argv[1] + "/lib")), ""))
PYTHONDIR ?= $(or $(shell $(PYTHON3) -c '$(PYTHON_LOOKS)' $(PREFIX) 2>/dev/null),$(PREFIX)/lib/python3/dist-packages)

SHADE_VERSION := $(shell sed -n 's/^.define SHADE_VERSION "\(.*\)"/\1/p' $(L)/include/shade/shade.h)
# what callers hold in their memory may still change with a minor release: until 1.0 each of them
# is an interface of its own
SHADE_SONAME := $(if $(TARGET_IS_WINDOWS),libshade-$(basename $(SHADE_VERSION)).dll,$(if \
  $(TARGET_IS_MACOS),libshade.$(basename $(SHADE_VERSION)).dylib,libshade.so.$(basename $(SHADE_VERSION))))
SHADE_SHARED := $(if $(TARGET_IS_WINDOWS)$(TARGET_IS_MACOS),$(SHADE_SONAME),libshade.so.$(SHADE_VERSION))

# Its symbols carry the interface they are of: a program says what it was linked with.
$(B)/libshade.map: $(L)/include/shade/shade.h
	@mkdir -p $(@D)
	@echo 'LIBSHADE_$(basename $(SHADE_VERSION)) { global: shade_*; local: *; };' >$@
ifneq ($(TARGET_IS_WINDOWS),)
# Windows has no versions of symbols: the names that the headers declare, which are all that a caller sees
$(B)/libshade.def: $(L)/port/exports.awk $(wildcard $(L)/include/shade/*.h)
	@mkdir -p $(@D)
	$(Q)awk -f $^ >$@
$(B)/$(SHADE_SHARED): $(SHADE_OBJ) $(B)/libshade.def
	$(call say,link     ,$@)
	$(Q)$(CC) -shared -static -Wl,--no-insert-timestamp,--out-implib=$(B)/libshade.dll.a $(CFLAGS) $(LDFLAGS) $^ -lm -o $@
else ifneq ($(TARGET_IS_MACOS),)
$(B)/$(SHADE_SHARED): $(SHADE_OBJ)
	$(call say,link     ,$@)
	$(Q)$(CC) -shared -Wl,-install_name,@rpath/$(SHADE_SONAME) $(CFLAGS) $(LDFLAGS) $^ -lm -o $@
else
# Under its full name only: with a link libshade.so beside libshade.a, -lshade would take it.
$(B)/$(SHADE_SHARED): $(SHADE_OBJ) | $(B)/libshade.map
	$(call say,link     ,$@)
	$(Q)$(CC) -shared -Wl,-soname,$(SHADE_SONAME),--version-script=$(B)/libshade.map $(if $(findstring -fsanitize,$(CFLAGS)),,-Wl,-z,defs) $(CFLAGS) $(LDFLAGS) $^ -lm -o $@
endif

# The interface as a text: functions, and the sizes, members and values of what they take. A test compares
# it with the library (abidiff); what was meant to change is written anew.
ABI := $(L)/abi/libshade.abi
.PHONY: abi
abi: $(B)/$(SHADE_SHARED)
	@abidw --headers-dir $(L)/include/shade --drop-private-types --no-comp-dir-path --no-corpus-path --no-show-locs \
	  --type-id-style hash $< | sed '1a <!-- SPDX-License''-Identifier: Apache-2.0 -->' >$(ABI)

INSTALLED_HEADERS := $(wildcard $(L)/include/shade/*.h)

# The manual pages, of the comments of the headers and of what --help prints. awk is in any system that has make, so that a C
# compiler is enough. A tool made for another machine does not run here: its page says so.
SHADE_COMMANDS := eval check bench scratch slopes weave presets fabric swatch
SHADE_HELP := $(SHADE_COMMANDS:%=$(B)/help/%.txt)
$(SHADE_HELP): $(B)/help/%.txt: $(B)/shade
	@mkdir -p $(@D)
	$(Q)$< $* --help >$@ 2>/dev/null || echo "shade $* --help" >$@
HEADERS_IN_ORDER := $(patsubst %,$(L)/include/shade/%.h,table shade fabric presets maps weave albedo mesh)
MAN3 := $(B)/man/libshade.3
MAN1 := $(B)/man/shade.1
man_page = $(Q)mkdir -p $(@D) && { sed '/^@$(1)@/,$$d' $< && $(2) && sed '1,/^@$(1)@/d' $<; } | sed 's/@VERSION@/$(SHADE_VERSION)/' >$@
$(MAN3): $(L)/man/libshade.3.in $(L)/man/headers.awk $(INSTALLED_HEADERS)
	$(call say,manual   ,$@)
	$(call man_page,FUNCTIONS,awk -f $(L)/man/headers.awk $(HEADERS_IN_ORDER))
$(MAN1): $(L)/man/shade.1.in $(L)/man/help.awk $(SHADE_HELP)
	$(call say,manual   ,$@)
	$(call man_page,COMMANDS,awk -f $(L)/man/help.awk $(SHADE_HELP))
# the tool looks for it in ../libexec/shade from where it is itself
INSTALLED_MODULE = $(OIIO_MODULE:$(B)/%=$(LIBEXECDIR)/shade/%)
PYTHON_MODULE := $(wildcard $(L)/python/shade/*.py) $(L)/python/shade/py.typed
# beside it: where the library is, seen from there, so that both can be moved together
PYTHON_PLACE := library.txt
INSTALLED_PYTHON = $(addprefix $(PYTHONDIR)/shade/,$(notdir $(PYTHON_MODULE)) $(PYTHON_PLACE))
# where `make render` and `make farm` made them
RENDER_TOOL = $(wildcard $(B)/shade-render $(B)/libshade-farm)
INSTALLED_FILES = $(BINDIR)/shade $(BINDIR)/shade-render $(BINDIR)/libshade-farm $(INSTALLED_MODULE) $(LIBDIR)/libshade.a $(LIBDIR)/$(SHADE_SHARED) \
  $(LIBDIR)/$(SHADE_SONAME) $(LIBDIR)/libshade.so $(PKGCONFIGDIR)/libshade.pc $(CMAKE_PACKAGE:%=$(CMAKEDIR)/%) \
  $(INSTALLED_HEADERS:$(L)/include/%=$(INCLUDEDIR)/%) \
  $(MAN1:$(B)/man/%=$(MANDIR)/man1/%) $(MAN3:$(B)/man/%=$(MANDIR)/man3/%) \
  $(INSTALLED_PYTHON)

CMAKE_PACKAGE := libshadeConfig.cmake libshadeConfigVersion.cmake
seen_from = $(shell realpath -m -s --relative-to=$(1) $(2))
# directories below the prefix are written in its terms, so that the file can be moved with them
in_prefix = $(patsubst $(PREFIX)/%,$${prefix}/%,$(1))
define PC_OF
prefix=$(1)
libdir=$(2)
includedir=$(3)

Name: libshade
Description: Anisotropic shading whose microfacet distribution follows the perturbed normal
Version: $(SHADE_VERSION)
Cflags: -I$${includedir}
Libs: -L$${libdir} -lshade
Libs.private: -lm
endef
SHADE_PC = $(call PC_OF,$(PREFIX),$(call in_prefix,$(LIBDIR)),$(call in_prefix,$(INCLUDEDIR)))
# a name of our own: POV-Ray's configure reads PKGCONFIG
export SHADE_PC

# Archives for other machines (windows.mk, macos.mk, arm64.mk): a folder that can lie anywhere, with what is seen from its lib
MOVED_PC = $(call PC_OF,$${pcfiledir}/../..,$${prefix}/lib,$${prefix}/include)
export MOVED_PC
# $(1): the folder; $(2): the shared library, seen from lib; $(3): what CMake is told of it
define stage_library
	$(Q)mkdir -p $(addprefix $(1)/,include/shade lib/pkgconfig lib/cmake/libshade)
	$(Q)cp $(INSTALLED_HEADERS) $(1)/include/shade
	$(Q)cp LICENSES/Apache-2.0.txt $(1)/LICENSE.txt
	@echo "$$MOVED_PC" >$(1)/lib/pkgconfig/libshade.pc
	@for file in $(CMAKE_PACKAGE); do \
	  sed -e 's,@VERSION@,$(SHADE_VERSION),' -e 's,@MINOR@,$(basename $(SHADE_VERSION)),' -e 's,@LIB@,../..,' -e 's,@INCLUDE@,../../../include,' \
	    -e 's,@SHARED@,$(2),' -e 's,@NAMED@,$(3),' $(L)/cmake/$$file.in >$(1)/lib/cmake/libshade/$$file || exit 1; done
endef
# $(1): files, each in a folder that is named as what it is of
stage_licences = for file in $(1); do cp $$file $(2)/licences/$$(basename $$(dirname $$file)).txt || exit 1; done
# a folder as what tar unpacks: the same files are the same bytes, and programs stay programs
tar_of = mkdir -p $(@D) && tar --format=gnu --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=u+w,go-w,a+rX -C $(dir $(1)) -cf - $(notdir $(1)) | \
  gzip -9n >$@.part && mv $@.part $@
# of all that is there for others to fetch
SUMS = cd $(B)/release && sha256sum $$(ls | grep -E '\.(zip|tar\.gz)$$') >SHA256SUMS

.PHONY: install uninstall
install: all $(MAN1) $(MAN3)
	$(INSTALL) -d $(addprefix $(DESTDIR),$(BINDIR) $(LIBDIR) $(PKGCONFIGDIR) $(CMAKEDIR) $(INCLUDEDIR)/shade \
	  $(MANDIR)/man1 $(MANDIR)/man3 $(PYTHONDIR)/shade)
	$(INSTALL) -m 755 $(B)/shade $(RENDER_TOOL) $(DESTDIR)$(BINDIR)
	$(INSTALL) -m 644 $(B)/libshade.a $(B)/$(SHADE_SHARED) $(DESTDIR)$(LIBDIR)
	$(if $(OIIO_MODULE),$(INSTALL) -d $(DESTDIR)$(LIBEXECDIR)/shade && \
	  $(INSTALL) -m 644 $(OIIO_MODULE) $(DESTDIR)$(LIBEXECDIR)/shade)
	ln -sf $(SHADE_SHARED) $(DESTDIR)$(LIBDIR)/$(SHADE_SONAME)
	ln -sf $(SHADE_SONAME) $(DESTDIR)$(LIBDIR)/libshade.so
	$(INSTALL) -m 644 $(INSTALLED_HEADERS) $(DESTDIR)$(INCLUDEDIR)/shade
	$(INSTALL) -m 644 $(MAN1) $(DESTDIR)$(MANDIR)/man1
	$(INSTALL) -m 644 $(MAN3) $(DESTDIR)$(MANDIR)/man3
	$(INSTALL) -m 644 $(PYTHON_MODULE) $(DESTDIR)$(PYTHONDIR)/shade
	@echo $(call seen_from,$(PYTHONDIR)/shade,$(LIBDIR)/$(SHADE_SHARED)) \
	  >$(DESTDIR)$(PYTHONDIR)/shade/$(PYTHON_PLACE) && chmod 644 $(DESTDIR)$(PYTHONDIR)/shade/$(PYTHON_PLACE)
	@echo "$$SHADE_PC" >$(DESTDIR)$(PKGCONFIGDIR)/libshade.pc && \
	  chmod 644 $(DESTDIR)$(PKGCONFIGDIR)/libshade.pc
	@for file in $(CMAKE_PACKAGE); do \
	  sed -e 's,@VERSION@,$(SHADE_VERSION),' -e 's,@MINOR@,$(basename $(SHADE_VERSION)),' \
	    -e 's,@SHARED@,$(SHADE_SHARED),' -e 's,@NAMED@,IMPORTED_SONAME "$(SHADE_SONAME)",' \
	    -e 's,@LIB@,$(call seen_from,$(CMAKEDIR),$(LIBDIR)),' -e 's,@INCLUDE@,$(call seen_from,$(CMAKEDIR),$(INCLUDEDIR)),' \
	    $(L)/cmake/$$file.in >$(DESTDIR)$(CMAKEDIR)/$$file && chmod 644 $(DESTDIR)$(CMAKEDIR)/$$file || exit 1; done

# what `install` of this version, with these directories, put there
uninstall:
	rm -f $(addprefix $(DESTDIR),$(INSTALLED_FILES))
	rm -rf $(DESTDIR)$(PYTHONDIR)/shade/__pycache__
	for folder in $(addprefix $(DESTDIR),$(INCLUDEDIR)/shade $(LIBEXECDIR)/shade $(CMAKEDIR) $(PYTHONDIR)/shade); do \
	  if [ -d $$folder ]; then rmdir --ignore-fail-on-non-empty $$folder; fi; done

include $(L)/linux.mk
