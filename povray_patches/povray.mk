# SPDX-License-Identifier: AGPL-3.0-or-later
# POV-Ray with libshade: build/povray/povray, which runs without installation.
P := povray_patches
POVRAY := $(B)/povray/povray

# povray is phony: build.sh knows best what is up to date, and says it in a second
povray: povray-source $(B)/libshade_dump.a $(B)/libshade.a
	@EXR_LIBS="$(EXR_LIBS)" $(P)/build.sh $(B)/povray libshade $(B)/libshade_dump.a $(B)/libshade.a

# fetching, unpacking and configuring take half a minute of one processor: beside libshade's compilers
.PHONY: povray-source
povray-source: setup-povray
	@EXR_LIBS="$(EXR_LIBS)" PREPARE=1 $(P)/build.sh $(B)/povray libshade

# Debian's package of it and the archive that runs from any folder
.PHONY: povray-package
povray-package: povray | $(S)/package.stamp
	@$(P)/package/package.sh $(B)/povray $(B)/povray-package

# of the package: its tests, and a minimal Debian that it is installed in and removed from (about 80 s)
.PHONY: check-povray-package
soak: check-povray-package
check-povray-package: povray-package setup-test
	$(PY) -m pytest -q $(P)/tests/test_package.py
	rm -rf $(B)/chroot-package
	$(P)/package/check-install.sh $(B)/povray-package/*.deb $(B)/chroot-package

# The words of a block, for editors.
WORDS := $(B)/povray/editor/words.txt $(B)/povray/editor/pov.vim
povray: $(WORDS)
$(B)/povray/editor/words.txt: FORM := text
$(B)/povray/editor/pov.vim: FORM := vim
$(WORDS): $(B)/povray/editor/words
	@$< $(FORM) >$@
$(B)/povray/editor/words: $(P)/editor/words.cpp $(wildcard $(P)/glue/words.*) $(B)/libshade.a | setup-povray
	@mkdir -p $(@D)/include/backend
	@ln -sfn $(abspath $(P)/glue) $(@D)/include/backend/mdf
	@$(CXX) -O1 -Wall -Wextra -Wconversion $(WERROR) -I$(@D)/include -Ilibshade/include $< $(P)/glue/words.cpp $(B)/libshade.a -lm -lpthread -o $@

# "no existing scene changes", 200 broken blocks, and patches that compile one by one, on their own (about 4 min);
# in the tests the broken blocks are 25, and patches are compiled together
.PHONY: check-povray-scenes
soak: check-povray-scenes
check-povray-scenes: povray setup-test
	$(P)/check.sh $(POVRAY) povray $(B)/povray/src/distribution
	MUTATED=200 $(PY) -m pytest -q $(P)/tests/test_mutated.py
	SERIES=whole $(PY) -m pytest -q $(P)/tests/test_source.py -k each_patch
