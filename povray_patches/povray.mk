# SPDX-License-Identifier: AGPL-3.0-or-later
# POV-Ray with libshade: build/povray/povray, which runs without installation.
P := povray_patches
POVRAY := $(B)/povray/povray

# povray is phony: build.sh knows best what is up to date, and says it in a second
povray: setup-povray $(B)/libshade_dump.a $(B)/libshade.a
	@$(P)/build.sh $(B)/povray libshade $(B)/libshade_dump.a $(B)/libshade.a

# "no existing scene changes", on its own (about 50 s); also one of the tests
.PHONY: check-povray-scenes
check-povray-scenes: povray
	$(P)/check.sh $(POVRAY) povray $(B)/povray/src/distribution
