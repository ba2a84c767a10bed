# make bench: the kernels against a plain read of as many bytes in the same run, into build/out/bench/bench.tsv.
#
# Each program of pipelines/bench (but bench.c and problem.c, which they share) prints the rows of some kernels. Times
# in ns per pair of point and neighbour (streams: per row), least and percentiles over the repeats; bytes are those read
# and written (force loop: those of its table). One thread is timed by its CPU time, several by the clock: compare
# threads on an idle machine only.

BENCH := $(OUT)/bench
BENCH_SECONDS := 1
BENCH_SHARED := bench problem
BENCH_KERNELS := $(filter-out $(BENCH_SHARED),$(notdir $(basename $(wildcard pipelines/bench/*.c))))
BENCH_COLUMNS := kernel size threads ns_per_pair bytes_per_pair read_ns_per_pair ratio p10 p50 p90 rate \
    rate_unit bytes_per_node repeats clock cpu flags

.PHONY: bench
bench: $(BENCH)/bench.tsv
	@awk -F '\t' '{ printf "%-18s %-44s %2s %9s %6s %8s %8s %12s %s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$11, $$12 }' $<

$(BUILD)/pipelines/bench/%.o: CFLAGS += -DBENCH_FLAGS='"$(notdir $(CC)) $(OPTIMISE)"'

$(BENCH_KERNELS:%=$(BUILD)/bench/bench-%): $(BUILD)/bench/bench-%: $(BUILD)/pipelines/bench/%.o \
        $(BENCH_SHARED:%=$(BUILD)/pipelines/bench/%.o) $(LIBRARY)
	@mkdir -p $(@D)
	$(CC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

tested: $(BENCH_KERNELS:%=$(BUILD)/bench/bench-%)

# One after the other: they would disturb each other.
$(BENCH)/bench.tsv: $(BENCH_KERNELS:%=$(BUILD)/bench/bench-%) pipelines/bench.mk
	@mkdir -p $(@D)
	(echo $(BENCH_COLUMNS) | tr ' ' '\t'; for program in $(filter $(BUILD)/%,$^); do $$program $(BENCH_SECONDS); done) > $@
