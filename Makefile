# make            build the tools into build/bin
# make deps       install what is missing (Debian, Ubuntu)
# make mpi        mtled for several processes under mpirun, build/bin/mtled-mpi
# make check      run the tests                         make SAN=1 check   ... under sanitizers
# make check-all  the same, and those that take long and repeat on larger cases
# make faults, fuzz, lint, coverage: what the programs survive, what a fuzzer finds, static checks, lines under test
# make STUDY      run a study of pipelines/: tables and pictures into build/out/STUDY; minutes each:
#   table1  brain2d  brain3d    as in the papers: approximation, a brain section, the whole brain
#   hard                        cases with known answers
#   foreign  voxels             meshes as others make them, label images
#   neurosurgery                brain shift, from a label image to a warped scan
#   gallery  liver  phantom     examples that others can judge, with pictures
#   convergence  speed-error    error against mesh size, and against time, beside mixed elements and CalculiX
#   uncertainty                 brain shift with uncertain stiffness; cases of a table: pipelines/sweep
#   scale                       time, bytes and memory of each stage for a node
#   adaptive                    what the estimate of the discretisation error is worth; graded meshes against even ones
#   bench  estimate             speed of the kernels; what the estimate of the iteration's error is worth
# make refine SCENE=... GEO=... TOL=0.1mm    a scene of your own, on meshes refined where it must be (pipelines/refine.mk)
# make install PREFIX=/usr/local    make deb    make clean    (pipelines/install.mk)
# V=1 with any of them: the commands as they are run

# Waiting threads sleep, so that other programs on the same cores do not slow tests and studies down.
export OMP_WAIT_POLICY ?= passive

# A line for each file that is made; V=1: the commands instead. The shell is asked for at each line of a recipe: the first one tells.
ifndef V
.SILENT:
told = $(if $(told-$@),,$(eval told-$@ := 1)$(info $(if $(filter %.o,$@),CC   $<,MAKE $@)))
endif
SHELL = $(if $(findstring /,$@),$(told))/bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all

PREFIX ?= /usr/local
CC = gcc
# SAN=1: sanitizers; FUZZ=1: for libFuzzer (make fuzz); COVERAGE=1: for gcov (make coverage).
BUILD := build$(if $(SAN),-san)$(if $(FUZZ),-fuzz)$(if $(COVERAGE),-coverage)$(if $(filter clang%,$(CC)),-clang)
ifeq ($(strip $(BUILD)),)
$(error BUILD is empty: name a folder, else what is built would lie in /bin)
endif
OUT := build/out
# The last line of a study's recipe: the pictures that it needed.
PICTURES = @printf '%s\n' '' $(filter %.png %.gif,$^)

WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wstrict-prototypes -Wvla
HARDENING := -fstack-protector-strong -fPIE -Wformat -Wformat-security
OPTIMISE := $(if $(SAN)$(FUZZ),-O1 -fno-omit-frame-pointer,$(if $(COVERAGE),-O1,-O3 -fno-math-errno -fno-trapping-math -D_FORTIFY_SOURCE=2))
comma := ,
SANITIZE := $(if $(SAN)$(FUZZ),-fsanitize=address$(comma)undefined -fno-sanitize-recover=undefined) \
    $(if $(FUZZ),-fsanitize=fuzzer-no-link) $(if $(COVERAGE),--coverage -fprofile-update=atomic)
CFLAGS := -std=c11 -D_GNU_SOURCE -g -Ilib -Itools -Itools/common $(WARNINGS) $(HARDENING) $(OPTIMISE) $(SANITIZE) -fopenmp
LDFLAGS := -pie -Wl,-z,relro -Wl,-z,now -fopenmp $(SANITIZE)
LDLIBS := -lgsl -lgslcblas -lexpat -lz -lm

LIBRARY := $(BUILD)/libmtled.a
LIBRARY_OBJECTS := $(patsubst %.c,$(BUILD)/%.o,$(wildcard lib/*/*.c lib/*/*/*.c))
# Each .c of tools/ is a program. What belongs to one alone lies in a folder of its name, what several share in tools/common.
COMMON_OBJECTS := $(patsubst %.c,$(BUILD)/%.o,$(filter-out tools/mpi/%,$(wildcard tools/*/*.c tools/common/*/*.c)))
TOOLS := $(patsubst tools/%.c,%,$(wildcard tools/*.c))
PROGRAMS := $(TOOLS:%=$(BUILD)/bin/%)
UNIT_TESTS := $(patsubst tests/unit/%.c,$(BUILD)/tests/%,$(wildcard tests/unit/*.c))
FUZZ_TARGETS := $(patsubst tests/fuzz/%.c,$(BUILD)/fuzz/%,$(filter-out %/replay.c,$(wildcard tests/fuzz/*.c)))
MAN_PAGES := $(TOOLS:%=$(BUILD)/man/man1/%.1) $(patsubst tools/%,$(BUILD)/man/man5/%,$(wildcard tools/*.5))
# Programs that the command-line tests use.
TEST_HELPERS := $(BUILD)/tests/helper/damage $(BUILD)/tests/helper/phantom $(BUILD)/tests/helper/deny.so $(BUILD)/tests/helper/keep.so

.PHONY: all lib man deps check check-all tested clean always
all: $(PROGRAMS) $(MAN_PAGES)
man: $(MAN_PAGES)
lib: $(LIBRARY)

$(BUILD)/%.o: %.c Makefile
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -MMD -MP -c -o $@ $<

# Objects are kept, also those that make finds out about on the way to a program.
.PRECIOUS: $(BUILD)/%.o

# No fused multiplications there: neighbour lists, shape functions and sums along fields come out the same on every processor.
$(BUILD)/lib/approx/%.o $(BUILD)/lib/base/dense.o $(BUILD)/lib/solid/preconditioner/coarse_space.o: CFLAGS += -ffp-contract=off
# The force loop may fuse: to round-off it is the same everywhere, and to the bit for any number of threads.
$(BUILD)/lib/solid/body/kernel.o: CFLAGS += -ffp-contract=fast

$(LIBRARY): $(LIBRARY_OBJECTS)
	@rm -f $@
	ar rcs $@ $^

$(BUILD)/bin/%: $(BUILD)/tools/%.o $(COMMON_OBJECTS) $(LIBRARY)
	@mkdir -p $(@D)
	$(CC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# mtled for several processes, under mpirun: where MPI is there. How processes talk is all that differs.
# The compiler of openmpi-bin alone lacks the headers of libopenmpi-dev.
HAS_MPI := $(shell echo '\#include <mpi.h>' | mpicc -E -x c - > /dev/null 2>&1 && echo yes)
MPI_PROGRAM := $(BUILD)/bin/mtled-mpi
.PHONY: mpi has-mpi
mpi: $(MPI_PROGRAM)
has-mpi:
	@[ -n "$(HAS_MPI)" ] || { echo 'make: no MPI here: make deps installs it' >&2; false; }
$(BUILD)/tools/mpi/%.o: override CC = mpicc
$(BUILD)/tools/mpi/process.o: | has-mpi
$(MPI_PROGRAM): $(BUILD)/tools/mtled.o $(BUILD)/tools/mpi/process.o $(filter-out %/process.o,$(COMMON_OBJECTS)) $(LIBRARY)
	@mkdir -p $(@D)
	mpicc $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(BUILD)/tests/%: $(BUILD)/tests/unit/%.o $(LIBRARY)
	@mkdir -p $(@D)
	$(CC) $(LDFLAGS) -o $@ $^ $(LDLIBS) -lcmocka

$(BUILD)/tests/helper/damage $(BUILD)/tests/helper/phantom: $(BUILD)/tests/helper/%: $(BUILD)/tests/helper/%.o $(LIBRARY)
	$(CC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(BUILD)/tests/helper/%.so: tests/helper/%.c
	@mkdir -p $(@D)
	$(CC) -std=c11 -D_GNU_SOURCE $(WARNINGS) -O1 -shared -fPIC -o $@ $< -ldl

# Fuzz targets: with libFuzzer's main, or with one that replays files. Streams are read there without checksums.
$(BUILD)/fuzz/%: $(BUILD)/tests/fuzz/%.o $(if $(FUZZ),,$(BUILD)/tests/fuzz/replay.o) $(LIBRARY)
	@mkdir -p $(@D)
	$(CC) $(LDFLAGS) $(if $(FUZZ),-fsanitize=fuzzer) $(if $(filter stream,$*),-Wl$(comma)--wrap=crc32_z) -o $@ $^ $(LDLIBS)

$(BUILD)/man/man1/%.1: $(BUILD)/bin/% tools/man.awk
	@mkdir -p $(@D)
	$< -h | awk -f tools/man.awk > $@

$(BUILD)/man/man5/%: tools/%
	@mkdir -p $(@D)
	cp $< $@

$(BUILD)/man/man5/mts.5: tools/sections.awk lib/README.md tools/mts.5
	@mkdir -p $(@D)
	awk -f $^ > $@

# What is built needs what deps installs: with it, goals are made one after the other, whatever -j says.
ifneq ($(filter deps,$(MAKECMDGOALS)),)
.NOTPARALLEL:
endif

deps:
	@bash pipelines/deps.sh

# By a make of its own: after deps it finds what was installed, and builds on all cores.
tested: all $(if $(HAS_MPI),mpi) $(UNIT_TESTS) $(FUZZ_TARGETS) $(TEST_HELPERS)
check check-all:
	@$(MAKE) --no-print-directory -j$$(nproc) tested
	@BUILD="$(abspath $(BUILD))" $(if $(SAN)$(COVERAGE),LIMIT=3600) bash tests/run.sh $(if $(filter %-all,$@),all)

clean:
	rm -rf build build-*

# For files to be made whenever they are asked for.
always:

include pipelines/hard.mk # what others depend on
include $(filter-out pipelines/hard.mk,$(wildcard pipelines/*.mk))
-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)
