# SPDX-License-Identifier: Apache-2.0
# libshade-farm, one file that Python runs: build/libshade-farm. It needs Python alone; an item needs its renderer, too.
FARM := $(B)/libshade-farm
FARM_FILES := $(wildcard farm/*.py farm/engines/*.py farm/renderers/*.py)

.PHONY: farm soak-farm slurm
farm: $(FARM)
$(FARM): $(FARM_FILES)
	@mkdir -p $(@D)
	$(call say,zip      ,$@)
	$(Q)$(PYTHON3) farm pack-itself $@.part && mv $@.part $@

# its --help, which the manual shows
$(B)/help/farm.txt: $(FARM)
	@mkdir -p $(@D)
	$(Q)COLUMNS=100 $(PYTHON3) $< submit --help >$@

# A scheduler for the tests, where it can be had
slurm: | $(S)/test.packages
	@setup/slurm.sh
ifneq ($(filter check-before-pytest,$(MAKECMDGOALS)),)
check-before-pytest: farm slurm
endif
# more faults of a cluster, as root also by a plain user: some minutes
soak: soak-farm
soak-farm: $(RENDER) $(VENV)/done slurm
	@FAULTS=1 $(PY) -m pytest -q farm/tests/test_farm_slurm.py
