# SPDX-License-Identifier: Apache-2.0
# `make fuzz SECONDS=600`: each parser of text for that long, by clang's libFuzzer under
# AddressSanitizer and UndefinedBehaviorSanitizer. It starts from libshade/fuzz/corpus, which
# `make check` replays (test_corpus.c); what it finds goes to build/fuzz/, and a crash stops it.
FUZZERS := wif parse json
SECONDS ?= 60
FUZZ_CC ?= clang
FUZZ_FLAGS := -O1 -std=c11 -g -Wno-unknown-pragmas -fsanitize=fuzzer,address,undefined \
  -fno-sanitize-recover=all -I$(L)/include -I$(L)
# the kernels are not fuzzed: drafts, weaves and parsers only, before a library of the rest
FUZZ_SRC := $(L)/src/draft.c $(L)/src/weave.c $(wildcard $(L)/src/wif_*.c) $(L)/tool/parse.c $(L)/tool/json.c

$(B)/fuzz/%: $(L)/fuzz/fuzz_%.c $(FUZZ_SRC) $(wildcard $(L)/model/*.h $(L)/batch/*.h $(L)/include/shade/*.h) $(B)/libshade.a
	@mkdir -p $(@D)
	$(call say,compile  ,$@)
	$(Q)$(FUZZ_CC) $(FUZZ_FLAGS) $< $(FUZZ_SRC) $(B)/libshade.a -lm -o $@

.PHONY: fuzz $(FUZZERS:%=fuzz-%)
fuzz: $(FUZZERS:%=fuzz-%)
$(FUZZERS:%=fuzz-%): fuzz-%: $(B)/fuzz/%
	@mkdir -p $(B)/fuzz/$*-found
	$(B)/fuzz/$* -max_total_time=$(SECONDS) -max_len=4096 -timeout=20 -rss_limit_mb=4096 \
	  -dict=$(L)/fuzz/$*.dict -artifact_prefix=$(B)/fuzz/ -print_final_stats=1 \
	  $(B)/fuzz/$*-found $(L)/fuzz/corpus/$* $(if $(filter wif,$*),examples/weaves)
