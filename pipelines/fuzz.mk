# Not a study: fuzzing of all that reads untrusted bytes, TIME seconds for each target, by clang's libFuzzer under sanitizers.
# What it learns is kept in build/out/fuzz/TARGET; build/out/fuzz/fuzz.tsv adds up all runs. A crash stays beside it,
# and ends make with an error.

TIME ?= 60
FUZZ_NAMES := $(FUZZ_TARGETS:$(BUILD)/fuzz/%=%)

.PHONY: fuzz fuzz-build deps-fuzz
ifdef FUZZ
fuzz-build: $(FUZZ_TARGETS)
else
fuzz:
	$(MAKE) --no-print-directory FUZZ=1 CC=clang fuzz-build
	bash pipelines/fuzz.sh build-fuzz-clang/fuzz $(OUT)/fuzz $(TIME) $(FUZZ_NAMES)
endif

deps-fuzz:
	@bash pipelines/deps.sh fuzz
