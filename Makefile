# SPDX-License-Identifier: Apache-2.0
# One Makefile over all parts; each part's rules are in its own folder.
#   make          libshade and the `shade` tool (a C compiler is enough)
#   make demo     from nothing to pictures from both renderers and the verdict
#   make check    all tests
B := build
.DEFAULT_GOAL := all
.PHONY: all demo check bench blender povray compare clean help
include setup/setup.mk
include libshade/libshade.mk
include blender_addon_c/blender.mk
include povray_patches/povray.mk
include compare/compare.mk

clean:
	rm -rf $(B)
