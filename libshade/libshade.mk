# SPDX-License-Identifier: Apache-2.0
# libshade, the `shade` tool, their tests. Needs a C compiler and make, no more.
L := libshade
COMMA := ,
# what the compiler is and makes code for, as isa.c and port/ ask it; behind what CFLAGS may include
TARGET := $(shell printf '__x86_64__\n_WIN32\n__aarch64__\n__APPLE__\n__clang__\n' | $(CC) $(CFLAGS) -E -P -o - -xc - 2>/dev/null | tail -n 5)
TARGET_IS_X86_64 := $(filter 1,$(word 1,$(TARGET)))
TARGET_IS_WINDOWS := $(filter 1,$(word 2,$(TARGET)))
TARGET_IS_ARM64 := $(filter 1,$(word 3,$(TARGET)))
TARGET_IS_MACOS := $(filter 1,$(word 4,$(TARGET)))
CC_IS_GCC := $(if $(filter 1,$(word 5,$(TARGET))),,yes)
# a warning that a later compiler has stops tests, and nobody who only builds
ifneq ($(filter check check-% soak soak-%,$(MAKECMDGOALS)),)
export WERROR := -Werror
endif
# clang from 19 on warns of enumerations that count, too
SHADE_WARN := -Wall -Wextra -Wconversion $(WERROR) $(if $(CC_IS_GCC),,-Wno-enum-float-conversion -Wno-enum-enum-conversion)
# no path of this machine in what is built
NO_PATH := "-ffile-prefix-map=$(CURDIR)=."
# names and lines, which traces show; with variables too (CFLAGS=-g) compiling takes longer. What
# holds public functions has their types (`make abi`)
DEBUG := -g1
DEBUG_TYPES := -g
# how its programs are named, and what runs them here (windows.mk)
EXE := $(if $(TARGET_IS_WINDOWS),.exe)
RUN :=
# mingw-w64: C11's printf, and no warnings of its macro isfinite, which names a float of each argument. macOS: what POSIX lacks
SYSTEM_CFLAGS := $(if $(TARGET_IS_WINDOWS),-D__USE_MINGW_ANSI_STDIO=1 -Wno-float-conversion) $(if $(TARGET_IS_MACOS),-D_DARWIN_C_SOURCE)
SYSTEM_LIBS := $(if $(TARGET_IS_WINDOWS),-static,-ldl)
# gcc has vectors on the stack of Windows where their aligned moves fault (its bug 54412)
UNALIGNED := $(if $(TARGET_IS_WINDOWS),$(if $(CC_IS_GCC),-Wa$(COMMA)-muse-unaligned-vector-move))
SHADE_CFLAGS := -O3 -std=c11 $(DEBUG) -fPIC -fno-math-errno -fno-trapping-math -ffp-contract=fast \
  -fopenmp-simd -fvisibility=hidden $(NO_PATH) $(SHADE_WARN) $(SYSTEM_CFLAGS) -I$(L)/include -I$(L)
CFLAGS ?=
# one short line a step; V=1 shows the commands
Q := $(if $(V),,@)
say = $(if $(V),,@echo "  $(1)$(2)")

# gcc: partial redundancy elimination splits f(max(x, floor)) into f(x) and a constant, and the
# vectoriser computes both: a spurious exception, and slower
ONE_BRANCH := $(if $(CC_IS_GCC),-fno-tree-pre)
# no vectors outside the vectorised loops. clang packs two divisions into a vector of four, where
# the two that nobody reads are 0/0: a spurious exception, and slower. gcc reads in vectors what was
# just written one by one, and waits
FULL_VECTORS := $(if $(CC_IS_GCC),-fno-tree-slp-vectorize,-fno-slp-vectorize)
# gcc: no pairs of floats for what vectors of four leave over. It computes them in four lanes, the
# upper two with whatever a spill left there: a spurious exception (sse2: draws of Beckmann's)
NO_PAIRS := $(if $(CC_IS_GCC),--param=vect-epilogues-nomask=0)
ISA_scalar := $(FULL_VECTORS) -fno-openmp-simd -fno-tree-vectorize -Wno-unknown-pragmas
ISA_sse2 := $(ONE_BRANCH) $(FULL_VECTORS) $(NO_PAIRS)
ISA_avx2 := $(ONE_BRANCH) $(FULL_VECTORS) $(UNALIGNED) -mavx2 -mfma -mtune=haswell
ISA_avx512 := $(ONE_BRANCH) $(FULL_VECTORS) $(UNALIGNED) -march=x86-64-v4 -mprefer-vector-width=512 $(if $(CC_IS_GCC),-mtune=icelake-server)
ISA_neon := $(ONE_BRANCH) $(FULL_VECTORS)
ISAS := scalar $(if $(TARGET_IS_X86_64),sse2 avx2 avx512) $(if $(TARGET_IS_ARM64),neon)

O := $(B)/obj
# what is compiled once for each precision, and that once more for each instruction set
PRECISIONS := float double
in_both = $(foreach name,$(1),$(PRECISIONS:%=$(O)/src/$(name)_%.o))
isa_units = $(call in_both,$(1:%=isa_%))
SHADE_OBJ := $(call isa_units,$(ISAS)) $(call in_both,dispatch fabric_eval) $(O)/src/isa.o $(O)/src/status.o $(O)/src/params.o $(O)/src/setup.o \
  $(O)/src/roughness.o $(O)/src/tangents.o \
  $(O)/src/draft.o $(O)/src/weave.o $(O)/src/wif_words.o $(O)/src/wif_read.o \
  $(O)/src/wif_draft.o $(O)/src/wif_write.o
SHADE_OBJ += $(O)/src/moments.o $(O)/src/scratch.o $(O)/src/scratch_bins.o $(O)/src/scratch_table.o \
  $(O)/src/slopes.o $(O)/src/relief.o $(O)/src/albedo.o
SHADE_OBJ += $(O)/port/files.o $(if $(TARGET_IS_MACOS),$(O)/port/processor.o)
PORT_OBJ := $(O)/port/process.o $(O)/port/threads.o $(O)/port/map.o
REF_OBJ := $(patsubst $(L)/reference/%.c,$(O)/reference/%.o,$(wildcard $(L)/reference/*.c))
SHADE_OBJ += $(O)/src/fabric.o $(O)/src/fabric_nodes.o \
  $(O)/src/fabric_table.o $(O)/src/fabric_shadow.o $(O)/src/fabric_albedo.o \
  $(O)/src/fabric_json.o $(O)/src/presets.o
WHOLE_OBJ := $(O)/dump/whole.o
DUMP_OBJ := $(O)/dump/dump.o $(O)/dump/dump_linked.o
IMAGE_OBJ := $(O)/image/image.o
TOOL_OBJ := $(PORT_OBJ) $(O)/tool/main.o $(O)/tool/eval.o $(O)/tool/bench.o $(O)/tool/bench_cloth.o $(O)/tool/bench_lanes.o $(O)/tool/bench_maps.o \
  $(O)/tool/bench_diffuse.o \
  $(O)/tool/check.o $(O)/tool/json.o \
  $(O)/tool/work.o $(O)/tool/parse.o $(O)/tool/text.o $(O)/tool/weave.o $(ISAS:%=$(O)/tool/literal_%.o)

# `shade check` reads EXR: compiled in where OpenEXRCore's header and library are found
EXR_CFLAGS := $(shell pkg-config --cflags OpenEXR 2>/dev/null)
EXR_LIBS := $(shell for library in -lOpenEXRCore-3_1 -lOpenEXRCore; do printf '\043include <openexr.h>\nint main(void){return 0;}' | \
  $(CC) $(EXR_CFLAGS) -xc - -o /dev/null $$library 2>/dev/null && echo $$library && break; done)
ifneq ($(EXR_LIBS),)
TOOL_EXR := -DHAVE_OPENEXR
TOOL_OBJ += $(DUMP_OBJ) $(O)/tool/check_header.o $(O)/tool/check_hit.o $(O)/tool/check_compare.o \
  $(O)/tool/check_report.o $(O)/tool/check_fabric.o
endif

# pictures as PNG: likewise with libpng
PNG_CFLAGS := $(shell pkg-config --cflags libpng 2>/dev/null)
PNG_LIBS := $(shell printf '\043include <png.h>\nint main(void){return 0;}' | \
  $(CC) $(PNG_CFLAGS) -xc - -o /dev/null -lpng16 2>/dev/null && echo -lpng16)
IMAGE_FORMATS := $(TOOL_EXR) $(if $(PNG_LIBS),-DHAVE_PNG)
IMAGE_OBJ += $(if $(EXR_LIBS),$(O)/image/image_exr.o) $(if $(PNG_LIBS),$(O)/image/image_png.o)
TOOL_OBJ += $(IMAGE_OBJ) $(WHOLE_OBJ) $(O)/tool/scratch.o
TOOL_OBJ += $(O)/image/read.o $(O)/tool/slopes.o $(O)/tool/numbers.o $(O)/tool/points.o

# pictures of any format are read by a module that the tool loads when it needs it, made
# where OpenImageIO is found. Its header is only looked for: to read it takes a second and a half,
# whenever make starts
OIIO_LIBS := $(shell printf '\043if !__has_include(<OpenImageIO/imageio.h>)\n\043error\n\043endif\nint main(){return 0;}' | \
  $(CXX) -xc++ - -o /dev/null -lOpenImageIO 2>/dev/null && echo -lOpenImageIO -lOpenImageIO_Util)
OIIO_MODULE := $(if $(OIIO_LIBS),$(B)/shade_image_oiio.so)
$(B)/shade_image_oiio.so: $(L)/image/read_oiio.cpp $(L)/image/read.h $(L)/libshade.mk
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CXX) -O2 -std=c++17 $(DEBUG) -fPIC -shared -fvisibility=hidden $(NO_PATH) -Wall -Wextra $(WERROR) \
	  -I$(L) $(CFLAGS) $(LDFLAGS) $< $(OIIO_LIBS) -o $@
TOOL_OBJ += $(O)/tool/swatch.o $(O)/tool/presets.o $(O)/tool/fabric.o

# a tool built before a library came, or after it went, is built again
EXR_SEEN := $(O)/tool/openexr-$(if $(EXR_LIBS),yes,no)
PNG_SEEN := $(O)/tool/png-$(if $(PNG_LIBS),yes,no)
$(EXR_SEEN) $(PNG_SEEN):
	@mkdir -p $(@D)
	@rm -f $(patsubst %-yes,%-*,$(patsubst %-no,%-*,$@)) && touch $@
$(O)/tool/check.o: $(EXR_SEEN)
$(O)/image/image.o: $(EXR_SEEN) $(PNG_SEEN)

include $(L)/install.mk
all: $(B)/libshade.a $(B)/$(SHADE_SHARED) $(B)/shade$(EXE) $(OIIO_MODULE)

# Instruction sets that nobody runs in a build with sanitizers are taken from the build PLAIN_B: such a
# build spends most of its time on instrumenting them. Public calls run the widest, matt alone the scalar one.
RUN_ISAS = scalar $(shell $(B)/shade --version | sed 's/.*(\(.*\)).*/\1/')
UNRUN_ISAS = $(filter-out $(RUN_ISAS),$(ISAS))
PLAIN_ISAS :=
ISA_LEVEL :=
ifneq ($(PLAIN_ISAS),)
$(call isa_units,$(PLAIN_ISAS)): $(O)/src/isa_%.o: $(PLAIN_B)/obj/src/isa_%.o
	@mkdir -p $(@D)
	$(call say,copy     ,$@)
	$(Q)cp $< $@
endif
define PRECISION_RULES
$(O)/src/isa_%_$(1).o: $(L)/src/entries.c $(L)/libshade.mk
	@mkdir -p $$(@D)
	$$(call say,compile  ,$$@)
	$$(Q)$$(CC) $$(SHADE_CFLAGS) $$(ISA_$$*) -DISA=$$* -DSHADE_FLOAT=$(if $(filter float,$(1)),1,0) $$(CFLAGS) $$(ISA_LEVEL) -MMD -c $$< -o $$@
$(O)/src/%_$(1).o: $(L)/src/%.c $(L)/libshade.mk
	@mkdir -p $$(@D)
	$$(call say,compile  ,$$@)
	$$(Q)$$(CC) $$(SHADE_CFLAGS) $$(DEBUG_TYPES) -DSHADE_FLOAT=$(if $(filter float,$(1)),1,0) $$(CFLAGS) -MMD -c $$< -o $$@
endef
$(foreach precision,$(PRECISIONS),$(eval $(call PRECISION_RULES,$(precision))))
$(O)/src/%.o: $(L)/src/%.c $(L)/libshade.mk
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(SHADE_CFLAGS) $(DEBUG_TYPES) $(CFLAGS) -MMD -c $< -o $@
$(O)/port/%.o: $(L)/port/%.c $(L)/libshade.mk
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(SHADE_CFLAGS) $(CFLAGS) -MMD -c $< -o $@
$(O)/dump/%.o: $(L)/dump/%.c $(L)/libshade.mk
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(SHADE_CFLAGS) $(EXR_CFLAGS) $(CFLAGS) -MMD -c $< -o $@
$(O)/image/%.o: $(L)/image/%.c $(L)/libshade.mk
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(SHADE_CFLAGS) $(IMAGE_FORMATS) $(EXR_CFLAGS) $(PNG_CFLAGS) $(CFLAGS) -MMD -c $< -o $@
$(O)/tool/%.o: $(L)/tool/%.c $(L)/libshade.mk
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(SHADE_CFLAGS) $(TOOL_EXR) $(CFLAGS) -MMD -c $< -o $@
# gcc 12 fails to vectorise it for arm64 (in vect_transform_reduction)
$(O)/tool/bench_cloth.o: CFLAGS += $(if $(TARGET_IS_ARM64),$(if $(CC_IS_GCC),-fno-tree-vectorize))
# what `shade bench` times beside the library, under the library's flags
$(ISAS:%=$(O)/tool/literal_%.o): $(O)/tool/literal_%.o: $(L)/tool/literal.c $(L)/libshade.mk
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) $(SHADE_CFLAGS) $(ISA_$*) -DISA=$* $(CFLAGS) -MMD -c $< -o $@
# the reference is plain C: no flags that would bend its arithmetic
$(O)/reference/%.o: $(L)/reference/%.c $(L)/libshade.mk
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) -O2 -std=c11 $(DEBUG) -fPIC -ffp-contract=off $(NO_PATH) $(SHADE_WARN) $(SYSTEM_CFLAGS) -I$(L)/include $(CFLAGS) -MMD -c $< -o $@

$(B)/libshade.a: $(SHADE_OBJ)
	$(call say,archive  ,$@)
	$(Q)rm -f $@ && $(AR) rcs $@ $^
$(B)/libshade_dump.a: $(DUMP_OBJ) $(WHOLE_OBJ)
	$(call say,archive  ,$@)
	$(Q)rm -f $@ && $(AR) rcs $@ $^
$(B)/shade$(EXE): $(TOOL_OBJ) $(REF_OBJ) $(B)/libshade.a
	$(call say,link     ,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) $^ $(EXR_LIBS) $(PNG_LIBS) -pthread $(SYSTEM_LIBS) -lm -o $@

# the compiler makes these beside its objects: no rule is to be looked for
%.d: ;
# a header that went is no reason to stop: what named it is compiled again
%.h: ;
-include $(wildcard $(O)/*/*.d)

# Tests: one cmocka program per behaviour. `check-libshade` runs them as built, and those that ask about memory
# and branches under AddressSanitizer and UndefinedBehaviorSanitizer; clang is asked for its warnings.
TESTS := $(patsubst $(L)/test/test_%.c,$(B)/test/%$(EXE),$(wildcard $(L)/test/test_*.c))
CMOCKA_LIBS := -lcmocka
TEST_LIBS := $(REF_OBJ) $(O)/tool/json.o $(O)/tool/parse.o $(O)/tool/work.o $(PORT_OBJ) $(IMAGE_OBJ) $(B)/libshade_dump.a $(B)/libshade.a
$(B)/test/%$(EXE): $(L)/test/test_%.c $(TEST_LIBS)
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(CC) -O2 -std=c11 $(DEBUG) $(SHADE_WARN) $(SYSTEM_CFLAGS) -I$(L)/include -I$(L) $(EXR_CFLAGS) $(CFLAGS) -MMD $< $(TEST_LIBS) \
	  $(CMOCKA_LIBS) $(EXR_LIBS) $(PNG_LIBS) -pthread $(SYSTEM_LIBS) -lm -o $@
-include $(wildcard $(B)/test/*.d)

# speed beside accuracy, of the library alone, also in docs/results/; `make compare` times the renderers
bench: $(B)/shade
	@$(B)/shade bench --output $(B)/bench.csv
	@$(PYTHON3) compare/results.py bench $(B)/bench.csv
# make bench-pairs BEFORE=COMMIT PAIRS="--pairs 5 --what f"
.PHONY: bench-pairs
bench-pairs: $(B)/shade
	@$(if $(BEFORE),,echo "make bench-pairs: BEFORE=COMMIT is missing: what to compare with" >&2; exit 2;) \
	setup/bench_pairs.py $(BEFORE) $(B)/shade --output $(B)/bench_pairs.csv $(PAIRS)

.PHONY: test-libshade check-libshade check-headers soak $(TESTS:%=%.run)
# each a target of its own, so that -j runs several at once; the dearest first, as their heads say (setup/costs.py), or
# they run alone at the end
DEAREST := $(shell grep -H '^/\* COST = ' $(TESTS:$(B)/test/%$(EXE)=$(L)/test/test_%.c) | sort -t= -k2 -rn | sed 's,.*/test_\(.*\)\.c:.*,\1,')
test-libshade: $(DEAREST:%=$(B)/test/%$(EXE).run) $(TESTS:%=%.run)
$(TESTS:%=%.run): %.run: %
	@$(RUN) $<

# a hundred million cases, on all processors: some minutes
soak: $(B)/test/soak $(B)/test/fabric_soak $(B)/test/hostile
	@$(B)/test/soak --cases 100000000
	@$(B)/test/fabric_soak --cases 10000000
	@$(B)/test/hostile --samples 20000000

# The public headers: C++17 from both compilers, a program that links; C11 and nothing more.
check-headers: $(B)/libshade.a
	@mkdir -p $(B)/test
	$(call say,check    ,headers in C++17 and C11)
	$(Q)for cxx in g++ clang++; do \
	  $$cxx -std=c++17 -pedantic $(SHADE_WARN) -I$(L)/include $(L)/test/header.cpp $(B)/libshade.a -lm \
	    -o $(B)/test/header-$$cxx && $(B)/test/header-$$cxx || exit 1; done
	$(Q)for cc in gcc clang; do for header in $(L)/include/shade/*.h; do \
	  printf "#include \"shade/$${header##*/}\"\ntypedef int used;\n" | $$cc -std=c11 -pedantic-errors $(SHADE_WARN) \
	    -I$(L)/include -xc -fsyntax-only - || exit 1; done; done

# not asked: what AddressSanitizer says too, once such a pointer is used; it takes long to compile and to run
SANITIZE := -fsanitize=address,undefined -fno-sanitize=null,pointer-overflow,object-size -fno-sanitize-recover=all
# kernels compile sooner at -Og, and run hardly slower
# NEEDS: what is set up is that of the make above
SANITIZED_BUILD = NEEDS= B=$(B)/sanitized CFLAGS="-O1 $(SANITIZE)" ISA_LEVEL=-Og PLAIN_B=$(B) PLAIN_ISAS="$(UNRUN_ISAS)"
# These put more numbers through calls that `soak`, `fabric_soak` and `hostile` make too: under sanitizers in `make soak`
NUMBERS := accuracy continuity elementary fabric fabric_draw fabric_energy fabric_light furnace horizon lobes papers pdf sample
SANITIZED_TESTS := $(filter-out $(NUMBERS:%=$(B)/test/%),$(DEAREST:%=$(B)/test/%) $(TESTS))
# beside each other: the long test at the end of one leaves no processor idle
CHECKS := check-plain check-sanitized check-headers check-threads check-clang check-door
.PHONY: $(CHECKS) sanitized warnings
check-libshade: $(CHECKS)
check-plain: all test-libshade
# one make for all that is sanitized; native.mk has more for it
SANITIZED_GOALS := $(B)/sanitized/shade
check-sanitized: $(B)/shade
	$(Q)$(MAKE) $(SANITIZED_BUILD) $(SANITIZED_GOALS) $(subst $(B)/,$(B)/sanitized/,$(SANITIZED_TESTS:%=%.run))
sanitized: $(B)/shade
	$(Q)$(MAKE) $(SANITIZED_BUILD) $(SANITIZED_GOALS)
# on the scalar form: the vectors share nothing else between threads
check-threads: $(B)/shade
	$(Q)LIBSHADE_ISA=scalar $(MAKE) B=$(B)/threads CFLAGS="-O1 -fsanitize=thread" ISA_LEVEL=-Og PLAIN_B=$(B) PLAIN_ISAS="$(filter-out scalar,$(ISAS))" \
	  $(B)/threads/test/threads.run
# The second compiler reads all and says what it has to; what it makes of it runs in `make soak`. No object is written.
WARNED := warnings
check-clang:
	$(Q)$(MAKE) B=$(B)/clang-warnings CC=clang CFLAGS=-fsyntax-only $(WARNED)
WARNED_TESTS := $(wildcard $(L)/test/*.c)
warnings: $(SHADE_OBJ) $(REF_OBJ) $(DUMP_OBJ) $(WHOLE_OBJ) $(TOOL_OBJ)
	$(Q)$(CC) -std=c11 $(SHADE_WARN) $(SYSTEM_CFLAGS) -I$(L)/include -I$(L) $(EXR_CFLAGS) $(CFLAGS) -fsyntax-only $(WARNED_TESTS)

# what asks too much of a day's check: all programs under sanitizers, and those that compilers differ in as clang's
CLANG_RUNS := accuracy bsdf horizon hostile leaves sample
soak: soak-sanitized soak-clang
soak-sanitized: $(B)/shade
	$(Q)$(MAKE) $(SANITIZED_BUILD) test-libshade
CLANG_BUILD = NEEDS= B=$(B)/clang CC=clang CFLAGS=-DSANITIZED
soak-clang:
	$(Q)$(MAKE) $(CLANG_BUILD) $(B)/clang/soak.txt all $(subst $(B)/,$(B)/clang/,$(CLANG_RUNS:%=$(B)/test/%.run))
.PHONY: soak-sanitized soak-clang
.PHONY: $(B)/soak.txt # run each time, as tests are
$(B)/soak.txt: $(B)/test/soak
	@$< --cases 200000 >$@

include $(L)/fuzz/fuzz.mk
include $(L)/windows.mk
include $(L)/macos.mk
include $(L)/arm64.mk
