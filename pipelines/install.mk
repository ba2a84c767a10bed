# Not a study: `make install PREFIX=/usr/local` installs programs, man pages, completions and the Python package
# (install-programs), and the library with its headers and a file for pkg-config (install-library); `make deb` builds the
# package $(DEB) of the former. DESTDIR goes before PREFIX where a tree is to be moved later.

VERSION := $(shell sed -n 's/^.define MTS_VERSION "\(.*\)"/\1/p' lib/io/stream/stream.h)
# Without those that are for their own room: the name or the text says so.
HEADERS := $(filter-out %_private.h,$(shell grep -LiE '(private to|inside of) lib/' lib/*/*.h lib/*/*/*.h))
COMPLETIONS := $(TOOLS:%=$(BUILD)/completions/%)
DEB = $(BUILD)/mtled_$(VERSION)_$(shell dpkg --print-architecture).deb
INTO = $(DESTDIR)$(PREFIX)
# Where Debian's Python looks: one folder for all versions below /usr, one for each elsewhere.
PYTHON_SITE ?= $(PREFIX)/lib/python$(if $(filter /usr,$(PREFIX)),3,$(shell python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])'))/dist-packages

.PHONY: install install-programs install-library deb
all: $(COMPLETIONS)
install: install-programs install-library

install-programs: all
	install -d $(INTO)/bin $(INTO)/share/man/man1 $(INTO)/share/man/man5 $(INTO)/share/bash-completion/completions
	install -m 755 $(PROGRAMS) $(wildcard $(MPI_PROGRAM)) $(INTO)/bin
	install -m 644 $(filter %.1,$(MAN_PAGES)) $(INTO)/share/man/man1
	install -m 644 $(filter %.5,$(MAN_PAGES)) $(INTO)/share/man/man5
	install -m 644 $(COMPLETIONS) $(INTO)/share/bash-completion/completions
	install -d $(DESTDIR)$(PYTHON_SITE)/mtled
	install -m 644 $(wildcard tools/python/mtled/*.py) $(DESTDIR)$(PYTHON_SITE)/mtled

install-library: $(LIBRARY)
	install -d $(INTO)/lib/pkgconfig $(sort $(dir $(HEADERS:lib/%=$(INTO)/include/mtled/%)))
	install -m 644 $(LIBRARY) $(INTO)/lib
	for header in $(HEADERS:lib/%=%); do install -m 644 lib/$$header $(INTO)/include/mtled/$$header; done
	sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|' pipelines/install/mtled.pc > $(INTO)/lib/pkgconfig/mtled.pc

$(BUILD)/completions/%: $(BUILD)/bin/% tools/completion.awk
	@mkdir -p $(@D)
	$< -h | awk -f tools/completion.awk > $@

deb: all
	rm -rf $(BUILD)/deb
	$(MAKE) --no-print-directory install-programs DESTDIR=$(abspath $(BUILD))/deb PREFIX=/usr
	bash pipelines/install/deb.sh $(BUILD)/deb $(VERSION) $(DEB)
