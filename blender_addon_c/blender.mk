# SPDX-License-Identifier: GPL-3.0-or-later
# The Blender add-on: build/blender/addons/libshade, so that BLENDER_USER_SCRIPTS=build/blender
# finds it, and the same as build/libshade-blender.zip.
BLENDER_ADDON := $(B)/blender/addons/libshade
include blender_addon_c/native.mk

BLENDER_FILES := $(patsubst blender_addon_c/%,$(BLENDER_ADDON)/%, \
  $(filter-out %/package.py %/make_assets.py, \
    $(wildcard blender_addon_c/*.py $(patsubst %,blender_addon_c/%/*.py,export fabric scratches))) blender_addon_c/blender_manifest.toml) \
  $(BLENDER_ADDON)/LICENSE.txt $(BLENDER_NATIVE)

# The add-on as Blender finds it, without the assets and the manual that are in the zip, too
BLENDER_READY := $(B)/blender/ready

# Of what was once there
BLENDER_STALE = $(filter-out $(BLENDER_FILES),$(shell find $(BLENDER_ADDON) -name '*.py'))

# Made in Blender by the add-on itself: again when what they hold changes, not with each change of the renderer.
BLENDER_CATALOGS := $(BLENDER_ADDON)/assets/blender_assets.cats.txt
BLENDER_ASSETS := $(patsubst %,$(BLENDER_ADDON)/assets/%.blend,metals fabrics grooves scratches) $(BLENDER_CATALOGS)

# The manual, whose other files lie beside its first page
BLENDER_MANUAL := $(BLENDER_ADDON)/manual/index.html

BLENDER_ZIPPED := $(BLENDER_FILES) $(BLENDER_ASSETS) $(BLENDER_MANUAL)
# of an unpacked add-on
rest_of_manual = $(shell find $(1)/manual -type f ! -path $(1)/manual/index.html)

blender: $(B)/libshade-blender.zip

# five hundred awkward scenes in either Blender, fewer in those of others' systems, which have the zip of `make release-addon`; all lights
# in both: some minutes
soak: soak-blender
SOAK_BPY = $(if $(filter 3.11,$(PYTHON_VERSION)),$(B)/venv-bpy-4.2/done $(B)/venv-bpy-4.5/done)
soak-blender: $(B)/libshade-blender.zip release-addon debian13 $(RENDER) $(SOAK_BPY)
	@$(B)/venv/bin/python blender_addon_c/tests/soak.py --seeds 500
	@$(B)/venv/bin/python blender_addon_c/tests/soak.py --seeds 100 --version 4.2 4.5 5.2 5.3 --zip $(RELEASE_ZIP)
	@BOTH=1 $(B)/venv/bin/python -m pytest -q blender_addon_c/tests/test_blender_lights.py blender_addon_c/tests/test_blender_sky.py \
	  blender_addon_c/tests/test_blender_release.py blender_addon_c/tests/test_blender_scratches.py
	@EDITS=2000 $(B)/venv/bin/python -m pytest -q -s blender_addon_c/tests/test_blender_window.py -k edited
.PHONY: soak-blender

$(BLENDER_ADDON)/%: blender_addon_c/%
	@mkdir -p $(@D)
	$(call say,copy     ,$@)
	$(Q)cp $< $@
$(BLENDER_ADDON)/LICENSE.txt: LICENSES/GPL-3.0-or-later.txt
	@mkdir -p $(@D)
	$(Q)cp $< $@

$(BLENDER_READY): $(BLENDER_FILES)
	$(Q)rm -f $(BLENDER_STALE)
	@touch $@

$(BLENDER_CATALOGS): blender_addon_c/make_assets.py $(patsubst %,blender_addon_c/%.py,nodes metal_tree builder groove export/strokes \
  $(addprefix fabric/,node maps place shade tree yarns) $(addprefix scratches/,field images tree)) \
  $(N)/scene/cloth_picture.c $(L)/src/presets.c $(L)/include/shade/table.h | $(BLENDER_READY)
	$(call say,render   ,$(@D))
	$(Q)BLENDER_USER_SCRIPTS=$(abspath $(B)/blender) blender -b --factory-startup --addons libshade --python-exit-code 1 -P $< \
	  -- $(abspath $(@D)) >$(B)/assets.log 2>&1 || { tail -20 $(B)/assets.log; exit 1; }
$(filter-out $(BLENDER_CATALOGS),$(BLENDER_ASSETS)): $(BLENDER_CATALOGS)

$(BLENDER_MANUAL): $(MANUAL)/index.html | $(BLENDER_READY)
	$(call say,copy     ,$@)
	$(Q)rm -rf $(@D) && cp -r $(<D) $(@D) && rm -f $(@D)/.buildinfo && touch $@

$(B)/libshade-blender.zip: blender_addon_c/package.py $(BLENDER_READY) $(BLENDER_ASSETS) $(BLENDER_MANUAL)
	$(call say,zip      ,$@)
	$(Q)/usr/bin/python3 $< $@ $(BLENDER_ADDON) $(BLENDER_ZIPPED) $(call rest_of_manual,$(BLENDER_ADDON))

include blender_addon_c/release.mk
include blender_addon_c/windows.mk
include blender_addon_c/macos.mk
