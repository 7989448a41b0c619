# SPDX-License-Identifier: GPL-3.0-or-later
# The renderer of the Blender engine: a Python module in C with its own copies of Embree, TBB and
# OpenEXRCore beside it. Needs python3-dev, libembree-dev, libopenexr-dev, patchelf.
N := blender_addon_c/native
NATIVE := $(B)/blender/native
NATIVE_SO := $(NATIVE)/_native$(if $(TARGET_IS_WINDOWS),.pyd,.abi3.so)
NATIVE_PYTHON := /usr/bin/python3
# formats of our own functions are taken for those of Windows' old printf: Linux's compilers look at them
NATIVE_SYSTEM_CFLAGS := $(if $(TARGET_IS_WINDOWS),-Wno-format -Wno-format-extra-args)
NATIVE_CFLAGS := -O3 -std=c11 $(DEBUG) -fPIC -fvisibility=hidden -fno-math-errno -fno-trapping-math \
  -ffp-contract=fast -fopenmp-simd "-ffile-prefix-map=$(CURDIR)=." -D_POSIX_C_SOURCE=200809L $(SHADE_WARN) $(SYSTEM_CFLAGS) $(NATIVE_SYSTEM_CFLAGS) \
  -I$(N) -I$(L)/include -I$(L)
NATIVE_PYTHON_CFLAGS = $(shell $(NATIVE_PYTHON) -c "import sysconfig as s; print('-I' + s.get_path('include'))")
# isa/<family>.c is compiled for each instruction set
NATIVE_ISAS := $(ISAS)
FAMILIES := $(patsubst $(N)/isa/%.c,%,$(filter-out %/choose.c,$(wildcard $(N)/isa/*.c)))
NATIVE_OBJ := $(foreach isa,$(NATIVE_ISAS),$(FAMILIES:%=$(NATIVE)/obj/isa/$(isa)/%.o)) \
  $(patsubst $(N)/%.c,$(NATIVE)/obj/%.o,$(filter-out $(FAMILIES:%=$(N)/isa/%.c),$(wildcard $(N)/*/*.c)))
WRAPPED := malloc calloc realloc $(if $(TARGET_IS_WINDOWS),,aligned_alloc posix_memalign) strdup free
# macOS' linkers have no --wrap: what is linked are copies that call the functions by those names
ifeq ($(TARGET_IS_MACOS),)
NATIVE_WRAP := $(WRAPPED:%=-Wl$(COMMA)--wrap=%)
wrapped = $(1)
else
NATIVE_WRAP :=
wrapped = $(patsubst $(B)/%,$(B)/wrapped/%,$(1))
OBJCOPY := llvm-objcopy
$(B)/wrapped/%: RENAMED = $(foreach name,$(WRAPPED),--redefine-sym _$(name)=___wrap_$(name))
$(B)/wrapped/%/system/memory.o: RENAMED = $(foreach name,$(WRAPPED),--redefine-sym ___real_$(name)=_$(name))
$(B)/wrapped/%: $(B)/%
	@mkdir -p $(@D)
	$(Q)$(OBJCOPY) $(RENAMED) $< $@
$(B)/wrapped/libshade.a: $(call wrapped,$(SHADE_OBJ))
$(B)/wrapped/libshade_dump.a: $(call wrapped,$(DUMP_OBJ) $(WHOLE_OBJ))
$(B)/wrapped/%.a:
	$(Q)rm -f $@ && $(AR) rcs $@ $^
endif
NATIVE_EXPORTS := $(N)/python/exports.map
NATIVE_LDFLAGS := -shared $(if $(TARGET_IS_WINDOWS),,$(if $(TARGET_IS_MACOS),-Wl$(COMMA)-install_name$(COMMA)@rpath/_native.abi3.so, \
  -Wl$(COMMA)--version-script=$(NATIVE_EXPORTS) -Wl$(COMMA)-Bsymbolic)) $(NATIVE_WRAP)
# where a module has to name what it takes its Python from (windows.mk)
NATIVE_PYTHON_LIBS :=

# What the module opens at run time, under names of our own: Blender has a TBB too, and the loader gives the first
# library of a name to all who ask for that name. Embree as its header: scene/accel.c
NATIVE_SYSTEM = $(firstword $(wildcard $(foreach name,$(1),$(shell $(CC) -print-file-name=$(name)))))
NATIVE_LIBS := $(patsubst %,$(NATIVE)/lib/libshade_%.so,embree tbb openexrcore)
BLENDER_NATIVE := $(patsubst $(NATIVE)/%,$(BLENDER_ADDON)/%,$(NATIVE_SO) $(NATIVE_LIBS))

# shade-render: all but Python, scenes from files. Linked with the system's OpenEXRCore and zlib
RENDER := $(B)/shade-render$(EXE)
RENDER_OWN := $(patsubst blender_addon_c/tool/%.c,$(NATIVE)/obj/tool/%.o,$(wildcard blender_addon_c/tool/*.c))
RENDER_OBJ := $(RENDER_OWN) $(filter-out $(NATIVE)/obj/python/%,$(NATIVE_OBJ)) \
  $(IMAGE_OBJ) $(O)/tool/json.o $(O)/tool/parse.o $(O)/tool/work.o $(PORT_OBJ) $(B)/libshade_dump.a $(B)/libshade.a

.PHONY: native render native-sanitized native-warnings soak-native soak-damaged
native: $(NATIVE_SO) $(NATIVE_LIBS) $(NATIVE)/test_stages$(EXE) $(NATIVE)/test_system$(EXE) $(RENDER)
# for test_native_build.py, which runs the other tests on it
SANITIZED_BUILD += PLAIN_NATIVE=$(NATIVE) PLAIN_STAGES="$(filter-out $(lastword $(RUN_ISAS)),$(ISAS))"
native-sanitized: $(B)/shade $(NATIVE_SO)
	$(Q)$(MAKE) --no-print-directory $(SANITIZED_BUILD) native
native-warnings: $(NATIVE_OBJ) $(RENDER_OWN)
	$(Q)$(CC) $(NATIVE_CFLAGS) -fsyntax-only blender_addon_c/tests/test_stages.c blender_addon_c/tests/test_system.c
# for another system: what is compiled once, without Python
.PHONY: native-read
native-read: $(filter-out $(NATIVE)/obj/isa/% $(NATIVE)/obj/python/%,$(NATIVE_OBJ)) $(RENDER_OWN)
ifneq ($(filter check-before-pytest,$(MAKECMDGOALS)),)
SANITIZED_GOALS += native
check-sanitized: $(NATIVE_SO)
WARNED += native-warnings
endif
soak: soak-native
soak-native: soak-clang
	$(Q)$(MAKE) $(CLANG_BUILD) native
	NATIVE_MODULE=$(abspath $(B))/clang/blender/native/_native.abi3.so $(PY) -m pytest -q blender_addon_c/tests/test_native_*.py
# saved scenes that are damaged, for shade-render under sanitizers
soak: soak-damaged
soak-damaged: $(RENDER) native-sanitized
	@$(PY) blender_addon_c/tests/damaged.py --seeds 5000 --tool $(B)/sanitized/shade-render

# `make fuzz`: a saved scene's reader and all that it fills, under sanitizers; the rest as it is
FUZZ_SCENE := $(wildcard $(patsubst %,$(N)/%/*.c,closure light node scene)) $(N)/render/read.c
FUZZ_SCENE_OBJ := $(filter-out $(NATIVE)/obj/tool/% $(patsubst $(N)/%.c,$(NATIVE)/obj/%.o,$(FUZZ_SCENE)) $(O)/tool/json.o,$(RENDER_OBJ))
$(B)/fuzz/scene: blender_addon_c/tests/fuzz_scene.c $(wildcard blender_addon_c/tool/[!m]*.c) $(L)/tool/json.c $(FUZZ_SCENE) $(FUZZ_SCENE_OBJ)
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(FUZZ_CC) $(FUZZ_FLAGS) -DFUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION -D_POSIX_C_SOURCE=200809L -I$(N) -Iblender_addon_c \
	  $(NATIVE_WRAP) $^ $(EXR_LIBS) $(PNG_LIBS) -lz -pthread -ldl -lm -o $@
fuzz: fuzz-scene
.PHONY: fuzz-scene
fuzz-scene: $(B)/fuzz/scene | $(VENV)/done
	@mkdir -p $(B)/fuzz/scene-found $(B)/fuzz/scene-corpus
	$(Q)$(PY) blender_addon_c/tests/damaged.py --corpus $(B)/fuzz/scene-corpus
	$(B)/fuzz/scene -max_total_time=$(SECONDS) -max_len=65536 -timeout=20 -rss_limit_mb=4096 -artifact_prefix=$(B)/fuzz/ \
	  -print_final_stats=1 $(B)/fuzz/scene-found $(B)/fuzz/scene-corpus

# where the flags are: objects made by others are made again
NATIVE_FLAGS_IN := blender_addon_c/native.mk libshade/libshade.mk
$(NATIVE)/obj/python/%.o: NATIVE_FOR = $(NATIVE_PYTHON_CFLAGS)
# headers of another Embree than the system's
NATIVE_EMBREE_CFLAGS :=
$(NATIVE)/obj/scene/accel.o: NATIVE_FOR = $(NATIVE_EMBREE_CFLAGS)
define NATIVE_COMPILE
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(NATIVE_CFLAGS) $(NATIVE_FOR) $(CFLAGS) -MMD -c $< -o $@
endef
$(NATIVE)/obj/%.o: $(N)/%.c $(NATIVE_FLAGS_IN)
	$(NATIVE_COMPILE)
# of the stages only the widest runs under sanitizers, not the scalar one either
PLAIN_STAGES :=
define NATIVE_STAGES_OF
$(NATIVE)/obj/isa/$(1)/%.o: NATIVE_FOR = $(ISA_$(1)) -DISA=$(1)
$(NATIVE)/obj/isa/$(1)/%.o: $(if $(filter $(1),$(PLAIN_STAGES)),$(PLAIN_NATIVE)/obj/isa/$(1)/%.o,$(N)/isa/%.c $(NATIVE_FLAGS_IN))
	$(if $(filter $(1),$(PLAIN_STAGES)),@mkdir -p $$(@D) && cp $$< $$@,$$(NATIVE_COMPILE))
endef
$(foreach isa,$(NATIVE_ISAS),$(eval $(call NATIVE_STAGES_OF,$(isa))))
NATIVE_ARCHIVES := $(O)/port/threads.o $(B)/libshade_dump.a $(B)/libshade.a
$(NATIVE_SO): $(call wrapped,$(NATIVE_OBJ) $(NATIVE_ARCHIVES)) $(NATIVE_EXPORTS)
	$(call say,link     ,$@)
	$(Q)$(CC) $(NATIVE_LDFLAGS) $(CFLAGS) $(LDFLAGS) $(filter %.o %.a,$^) $(NATIVE_PYTHON_LIBS) -lm -lpthread $(SYSTEM_LIBS) -o $@
render: $(RENDER)
$(NATIVE)/obj/tool/%.o: blender_addon_c/tool/%.c $(NATIVE_FLAGS_IN)
	$(NATIVE_COMPILE)
$(RENDER): $(call wrapped,$(RENDER_OBJ))
	$(call say,link     ,$@)
	$(Q)$(CC) $(NATIVE_WRAP) $(CFLAGS) $(LDFLAGS) $^ $(EXR_LIBS) $(PNG_LIBS) -lz -pthread $(SYSTEM_LIBS) -lm -o $@
# the stages without Python; needs cmocka
NATIVE_STAGES := $(filter $(NATIVE)/obj/isa/% $(NATIVE)/obj/scene/atmosphere% %/render/sampling.o %/scene/sky.o %/scene/emitters.o %/scene/texture.o %/system/memory.o %/system/message.o %/system/pages.o %/system/parallel.o,$(NATIVE_OBJ)) $(O)/port/threads.o $(B)/libshade.a
$(NATIVE)/test_stages$(EXE): blender_addon_c/tests/test_stages.c $(NATIVE_STAGES)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(NATIVE_CFLAGS) $(CFLAGS) -MMD -MF $(NATIVE)/obj/isa/test_stages.d $< $(NATIVE_STAGES) $(NATIVE_WRAP) $(CMOCKA_LIBS) -pthread $(SYSTEM_LIBS) -lm -o $@
# the door to the system; needs cmocka
NATIVE_DOOR := $(filter $(NATIVE)/obj/system/%,$(NATIVE_OBJ)) $(O)/port/threads.o
$(NATIVE)/test_system$(EXE): blender_addon_c/tests/test_system.c $(NATIVE_DOOR)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(NATIVE_CFLAGS) $(CFLAGS) -MMD -MF $(NATIVE)/obj/system/test_system.d $< $(NATIVE_DOOR) $(NATIVE_WRAP) $(CMOCKA_LIBS) -pthread $(SYSTEM_LIBS) -lm -o $@
-include $(wildcard $(NATIVE)/obj/*/*.d $(NATIVE)/obj/isa/*/*.d)
# one that is gone: what has included it is made again
$(N)/%.h: ;

# of one that exists when the recipe runs. patchelf does one thing a call: two names in one become the same
define NATIVE_OWN
	@mkdir -p $(@D)
	$(call say,copy     ,$@)
	$(Q)cp -L $(FROM) $@.part
	$(Q)for tbb in $$(patchelf --print-needed $@.part | grep '^libtbb'); do \
	  patchelf --replace-needed $$tbb libshade_tbb.so $@.part || exit 1; done
	$(Q)patchelf --set-soname $(@F) $@.part
	$(Q)patchelf --set-rpath '$$ORIGIN' $@.part
	$(Q)mv $@.part $@
endef
$(NATIVE)/lib/libshade_embree.so: FROM = $(call NATIVE_SYSTEM,libembree4.so.4 libembree3.so.3)
$(NATIVE)/lib/libshade_tbb.so: FROM = $(call NATIVE_SYSTEM,libtbb.so.12)
$(NATIVE)/lib/libshade_openexrcore.so: FROM = $(call NATIVE_SYSTEM,libOpenEXRCore-3_1.so.30 libOpenEXRCore.so)
$(NATIVE_LIBS): blender_addon_c/native.mk | $(S)/blender.stamp
	$(NATIVE_OWN)
# by a new name: a Blender that runs keeps the file it has loaded
$(BLENDER_ADDON)/%: $(NATIVE)/%
	@mkdir -p $(@D)
	$(call say,copy     ,$@)
	$(Q)cp $< $@.part && mv $@.part $@
