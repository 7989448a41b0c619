# SPDX-License-Identifier: GPL-3.0-or-later
# The Blender add-on: build/blender/addons/libshade (BLENDER_USER_SCRIPTS=build/blender)
# and the same as build/libshade-blender.zip.
BLENDER_ADDON := $(B)/blender/addons/libshade
include blender_addon_c/native.mk

BLENDER_FILES := $(patsubst blender_addon_c/%,$(BLENDER_ADDON)/%, \
	$(filter-out %/package.py,$(wildcard blender_addon_c/*.py)) blender_addon_c/blender_manifest.toml) \
	$(BLENDER_ADDON)/LICENSE

blender: $(B)/libshade-blender.zip

$(BLENDER_ADDON)/%: blender_addon_c/%
	@mkdir -p $(@D)
	cp $< $@
$(BLENDER_ADDON)/LICENSE: LICENSES/GPL-3.0-or-later.txt
	@mkdir -p $(@D)
	cp $< $@

$(B)/libshade-blender.zip: $(BLENDER_FILES) $(BLENDER_NATIVE) blender_addon_c/package.py
	/usr/bin/python3 blender_addon_c/package.py $(BLENDER_ADDON) $@
