# SPDX-License-Identifier: Apache-2.0
# Both renderers on one scene, judged: `make demo` is that for the example, `make compare`
# adds the truth by displacement and the speed beside Cycles.
DEMO := $(B)/demo
COMPARE := $(wildcard compare/*.py)
MEASURED := $(B)/horizon $(B)/displaced $(B)/bumps $(B)/plain.so
RENDERERS := $(BLENDER_READY) $(POVRAY) $(B)/shade
BLENDER ?= blender
export BLENDER

demo: $(DEMO)/agreed
	@cat $(DEMO)/table.txt

SUZANNE := $(wildcard examples/blender/suzanne/*.py examples/blender/parts.py)
$(DEMO)/suzanne.blend: $(SUZANNE) $(BLENDER_READY)
	@mkdir -p $(@D)
	@echo "Building the scene $@"
	@BLENDER_USER_SCRIPTS=$(B)/blender $(BLENDER) -b --factory-startup --addons libshade \
	  --python-exit-code 1 -P examples/blender/suzanne/make_scene.py -- $@ > $(DEMO)/scene.log 2>&1 \
	  || { tail -n 15 $(DEMO)/scene.log; exit 1; }

# `povray` decides itself whether the program must be made anew; its file's time then tells.
$(POVRAY): povray
	@:

# The table is kept, so that a second `make demo` shows it at once; the stamp says that it was good.
$(DEMO)/agreed: $(DEMO)/suzanne.blend $(RENDERERS) $(COMPARE)
	@rm -f $@
	@$(PY) compare/consistency.py --all --output $(DEMO) $< > $(DEMO)/table.txt \
	  || { cat $(DEMO)/table.txt; exit 1; }
	@touch $@

# choices of horizon against displaced bumps: a program of its own, no renderer
$(B)/horizon: compare/horizon.c $(O)/dump/whole.o $(B)/libshade.a
	$(call say,compile  ,$@)
	$(Q)$(CC) -O2 -std=c11 $(DEBUG) $(SHADE_WARN) -I$(L)/include -I$(L) $(CFLAGS) $^ -lm -o $@

# displaced surfaces beside the same bumps as normals, for study_truth.py: likewise
$(B)/displaced: $(wildcard compare/displaced/*.c compare/displaced/*.h) $(O)/dump/whole.o $(B)/libshade.a
	$(call say,compile  ,$@)
	$(Q)$(CC) -O2 -std=c11 $(DEBUG) $(SHADE_WARN) -I$(L)/include -I$(L) $(CFLAGS) $(filter-out %.h,$^) -lm -o $@

# the brightness of displaced bumps with all their reflections, for steep_bumps.py: likewise
$(B)/bumps: $(wildcard compare/bumps/*.c compare/bumps/*.h) $(O)/dump/whole.o $(B)/libshade.a
	$(call say,compile  ,$@)
	$(Q)$(CC) -O2 -std=c11 $(DEBUG) $(SHADE_WARN) -I$(L)/include -I$(L) $(CFLAGS) $(filter-out %.h,$^) -lm -o $@

# the same formulas in plain C, timed beside the library
$(B)/plain.so: compare/plain.c
	$(call say,compile  ,$@)
	$(Q)$(CC) -O2 -std=c11 $(DEBUG) $(SHADE_WARN) $(CFLAGS) -shared -fPIC $< -lm -o $@

# scenes of Debian's and PyPI's packages in our engine and in Cycles; FILES="--filter 'openshot' --count 5"
compare-files: $(B)/libshade-blender.zip $(VENV_BPY)/done
	@$(PY) compare/real_files.py $(FILES)

# materials of stock nodes, made here after what public libraries hold; MATERIALS="--filter oak --blender 5.0"
.PHONY: compare-materials
compare-materials: $(B)/libshade-blender.zip $(VENV_BPY)/done
	@$(PY) compare/materials.py $(MATERIALS)

# a block's cost: each scene beside its twin without
.PHONY: bench-povray
bench-povray: povray setup-test
	@$(PY) compare/twins.py $(POVRAY) -o $(B)/twins.csv

# The report: build/compare/report.html and the CSV files beside it. The quick one, two minutes on two idle
# cores, is build/compare/quick/report.html; what is done already is not done again.
.PHONY: compare-quick
compare-quick: $(RENDERERS) all $(MEASURED)
	@$(PY) compare/report_page.py --quick $(ENGINE:%=--engine %)

# The same plate in Cycles of 3.4 and 5.0 and in Mitsuba 3, beside ours: a section of the report of its own
.PHONY: compare-peers
compare-peers: $(B)/libshade-blender.zip all
	@$(PY) compare/report_page.py --only peers --output $(B)/compare/peers

# ENGINE=slurm: the pieces of the report by a cluster (docs/start/farm.md).
# Each judge is heard, and the report written, whether or not one before found something beyond its limits;
# that is then said last. One that found nothing is not asked again until a program or a script changes.
# --results: what is found stands in docs/results/ and in README.md.
JUDGES := "truth.py --results" "truth.py --surface scratches" "truth.py --light sky --results" slopes.py \
  "horizon.py --results" "steep_bumps.py --long --uneven --results" fabric.py "speed.py --results" "paths.py --results"
JUDGED := $(B)/compare/judged
compare: demo $(B)/libshade-blender.zip $(MEASURED)
	@echo "Judges first, each with its own progress; then the report:"; $(PY) compare/report_page.py --plan
	@missed=; mkdir -p $(JUDGED); for judge in $(JUDGES) "report_page.py --results"; do \
	  mark="$(JUDGED)/$$(echo "$$judge" | tr ' ' _)"; \
	  if [ -f "$$mark" ] && [ -z "$$(find $(RENDERERS) $(COMPARE) $(MEASURED) -newer "$$mark")" ]; then \
	    echo "compare/$$judge: within limits, as found before"; continue; \
	  fi; \
	  rm -f "$$mark"; touch "$$mark.begun"; \
	  set -- $$judge; [ "$$1" != report_page.py ] || set -- "$$@" $(ENGINE:%=--engine %); \
	  $(PY) compare/"$$@" || { [ $$? -eq 130 ] && exit 130; missed="$$missed compare/$$judge;"; continue; }; \
	  [ "$${judge%% *}" = report_page.py ] || mv "$$mark.begun" "$$mark"; \
	done; \
	[ -z "$$missed" ] || { echo "make compare: not within limits, or failed:$$missed see above" >&2; exit 1; }

# Whole frames of every example scene against another commit's build, in turns: make bench-frames BEFORE=COMMIT
# ONLY="plate pan" FRAMES="--minutes 20"
.PHONY: bench-frames
bench-frames: $(BLENDER_READY) $(B)/shade povray setup-demo
	@$(if $(BEFORE),,echo "make bench-frames: BEFORE=COMMIT is missing: what to compare with" >&2; exit 2;) \
	$(PY) compare/bench_frames.py $(BEFORE) $(if $(ONLY),--only $(ONLY)) $(FRAMES)
