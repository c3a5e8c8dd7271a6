# SPDX-License-Identifier: BSD-3-Clause
# Installation, included by the Makefile.
#
#   make install PREFIX=/usr/local DESTDIR=     installs everything that was built
#   make uninstall PREFIX= DESTDIR=             removes the same files
#   make bundle PREFIX=                         library, plugins, program and scenes alone, for a package of
#                                               another language

# Recipes, and the files written for pkg-config and CMake, hold these names unquoted. This comes first, before
# make expands them.
ifneq ($(filter install uninstall bundle,$(MAKECMDGOALS)),)
WRONG := $(shell tools/release/install unusable \
    $(foreach d,DESTDIR PREFIX BINDIR LIBDIR INCLUDEDIR DATADIR MANDIR DOCDIR,\
    $(if $(filter command environment,$(firstword $(origin $d))),'$d=$(subst ','\'',$(value $d))')))
$(if $(WRONG),$(error $(WRONG)))
endif

PREFIX     ?= /usr/local
DESTDIR    ?=
BINDIR     ?= $(PREFIX)/bin
LIBDIR     ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
DATADIR    ?= $(PREFIX)/share
MANDIR     ?= $(DATADIR)/man
DOCDIR     ?= $(DATADIR)/doc/weft
PLUGINDIR  := $(LIBDIR)/weft/plugins-1
export DESTDIR

SHARE := $(BUILD)/share
MAN := $(SHARE)/man/weft.1 $(SHARE)/man/weft-scene.5 $(SHARE)/man/weft-plugin.7
COMPLETIONS := $(SHARE)/weft.bash $(SHARE)/weft.zsh $(SHARE)/weft.fish
PLUGIN_A := $(PLUGINS:%=$(BUILD)/libweft-plugin-%.a)

.PHONY: install uninstall bundle share check-install check-docs site check-site check-abi renew-abi doxygen
share: $(MAN) $(COMPLETIONS) $(PLUGIN_A)
all: share

# A plugin to link into a program, for weft_registry_add or weft_plugin_method.
define ARCHIVE_RULE
$(BUILD)/libweft-plugin-$(1).a: $$(PLUGIN_OBJ_$(1))
	$$(call say,AR)rm -f $$@ && ar rcs $$@ $$^
endef
$(foreach p,$(PLUGINS),$(eval $(call ARCHIVE_RULE,$(p))))

# Manual pages and completions come from the program's help.
$(MAN) $(COMPLETIONS) &: $(BUILD)/weft tools/pages/manual tools/pages/completion docs/man/weft-plugin.7
	@mkdir -p $(SHARE)/man
	@$(HOST_WEFT) --version >/dev/null || { \
	    echo "$(HOST_WEFT) does not run here: HOST_WEFT= names a weft that does" >&2; exit 1; }
	$(call say,GEN)tools/pages/manual '$(HOST_WEFT)' $(SHARE)/man && tools/pages/completion '$(HOST_WEFT)' $(SHARE)

# Documentation, in the folders that its links use.
DOCS = README.md CONTRIBUTING.md CHANGELOG.md VERSIONING.md .github/CODE_OF_CONDUCT.md .github/SECURITY.md \
    LICENSE AUTHORS CITATION.cff $(wildcard docs/*.md docs/*/*.md docs/pictures/*.* docs/pictures/validation/* \
    examples/*.* examples/notebooks/* scenes/*) plugins/verlet/verlet.c

# Files to install, "from:to"; `to` is a directory if it ends with /.
FILES = $(BUILD)/weft:$(BINDIR)/ \
        $(foreach h,$(wildcard include/weft/*.h include/weft/*.hpp),$(h):$(INCLUDEDIR)/weft/) \
        $(BUILD)/libweft.a:$(LIBDIR)/ $(BUILD)/libweft.so:$(LIBDIR)/libweft.so.$(VERSION) \
        $(foreach p,$(PLUGINS),$(BUILD)/plugins/weft-$(p).so:$(PLUGINDIR)/ \
            $(BUILD)/libweft-plugin-$(p).a:$(LIBDIR)/) \
        $(foreach f,$(MPI_SO),$(f):$(PLUGINDIR)/) \
        $(foreach m,$(MAN),$(m):$(MANDIR)/man$(subst .,,$(suffix $(m)))/) \
        $(foreach d,$(DOCS),$(d):$(DOCDIR)/$(dir $(d))) \
        $(SHARE)/weft.bash:$(DATADIR)/bash-completion/completions/weft \
        $(SHARE)/weft.zsh:$(DATADIR)/zsh/site-functions/_weft \
        $(SHARE)/weft.fish:$(DATADIR)/fish/vendor_completions.d/weft.fish

install: all
	@tools/release/install put $(FILES)
	@PREFIX='$(PREFIX)' LIBDIR='$(LIBDIR)' INCLUDEDIR='$(INCLUDEDIR)' \
	    VERSION='$(VERSION)' SOVERSION='$(SOVERSION)' tools/release/install describe \
	    $(foreach p,$(PLUGINS),'$(p):$(LIBS_$(p))')

uninstall:
	@DOCDIR='$(DOCDIR)' LIBDIR='$(LIBDIR)' INCLUDEDIR='$(INCLUDEDIR)' \
	    VERSION='$(VERSION)' SOVERSION='$(SOVERSION)' tools/release/install remove $(FILES)

# Without HDF5 there is no program.
BUNDLED := $(BUILD)/libweft.so $(PLUGIN_SO) $(if $(HAVE_HDF5),$(BUILD)/weft)
bundle: $(BUNDLED)
	@DESTDIR= tools/release/install put $(BUILD)/libweft.so:$(LIBDIR)/libweft.so.$(SOVERSION) \
	    $(PLUGIN_SO:%=%:$(PLUGINDIR)/) $(if $(HAVE_HDF5),$(BUILD)/weft:$(BINDIR)/) \
	    $(foreach s,$(wildcard scenes/*),$(s):$(DOCDIR)/scenes/)

# Installs weft, moves it, builds the examples as C11 to C++17, removes it.
check-install: all $(EXAMPLES)
	@WHOLE=$(WHOLE) tools/checks/check-install $(BUILD)

# What a release consists of, in $(BUILD)/dist (docs/start/installation.md); DIST=TARGET...: of these targets alone.
.PHONY: dist check-dist
dist: all
	@tools/release/dist $(BUILD) $(BUILD)/dist $(BUILD)/dist-work $(DIST)
check-dist: dist hashes $(BUILD)/examples/minimal
	@DIST='$(DIST)' tools/checks/check-dist $(BUILD)

# Runs the commands of the pages, on scenes of a tenth of a second; WHOLE=1: on those that are shipped.
check-docs: all $(EXAMPLES)
	@WHOLE=$(WHOLE) tools/checks/check-docs $(BUILD) README.md docs/*.md docs/*/*.md CONTRIBUTING.md

# The pages of docs/ as a site that needs no network; the check makes it with short runs and follows its links.
site: all
	@tools/pages/site $(BUILD) $(BUILD)/site
check-site: all
	@tools/checks/check-site $(BUILD)

# Compares the interface of libweft.so with the dump of 0.2.0.
check-abi: $(BUILD)/libweft.so
	@tools/checks/check-abi $(BUILD)
renew-abi: $(BUILD)/libweft.so
	@tools/checks/check-abi $(BUILD) renew

# Makes pages from the public headers; a warning is an error.
doxygen:
	@mkdir -p $(BUILD)
	@BUILD=$(BUILD) doxygen docs/Doxyfile
	@echo "$(BUILD)/doxygen/html/index.html"
