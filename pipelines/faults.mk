# Not a study: every fault that the tools survive, tried once more and thoroughly, with what was observed: status and message
# of each case, in build/out/faults/faults.tsv. Fails when one is not survived. What is denied memory is tried under the
# sanitizers, too, in the build that `make SAN=1` makes.

FAULTS_TABLE := $(OUT)/faults/faults.tsv

.PHONY: faults
faults: $(FAULTS_TABLE)
	@cat $<
	@awk -F '\t' 'NR > 1 { n++; lost += $$5 != "yes"; split($$1, w, /[ :]/); faults += !seen[w[2]]++ } \
	    END { printf "%d faults, %d cases, %d not survived\n", faults, n, lost; exit lost > 0 || n == 0 }' $<

# faults BUILD ARGUMENTS: the tests of faults.bats.
FAULTS_TRY = PATH="$(abspath $(1))/bin:$$PATH" BUILD="$(abspath $(1))" THOROUGH=1 FAULTS="$(abspath $@)" \
    bats --tap $(2) > $(@D)/log || { cat $(@D)/log; false; }

$(FAULTS_TABLE): $(PROGRAMS) $(TEST_HELPERS) always
	@mkdir -p $(@D)
	@printf 'fault\tcase\tstatus\tmessage\tsurvived\n' > $@
	@$(call FAULTS_TRY,$(BUILD),tests/faults.bats tests/deny.bats)
ifndef SAN
	@$(MAKE) --no-print-directory SAN=1 CC=gcc all build-san/tests/helper/deny.so
	@$(call FAULTS_TRY,build-san,tests/deny.bats)
endif
