# Not a study: every fault that the tools survive, tried once more and thoroughly, with what was observed: status and message
# of each case, in build/out/faults/faults.tsv. Fails when one is not survived.

FAULTS_TABLE := $(OUT)/faults/faults.tsv

.PHONY: faults
faults: $(FAULTS_TABLE)
	@cat $<
	@awk -F '\t' 'NR > 1 { n++; lost += $$5 != "yes"; split($$1, w, /[ :]/); faults += !seen[w[2]]++ } \
	    END { printf "%d faults, %d cases, %d not survived\n", faults, n, lost; exit lost > 0 || n == 0 }' $<

$(FAULTS_TABLE): $(PROGRAMS) $(TEST_HELPERS) always
	@mkdir -p $(@D)
	@printf 'fault\tcase\tstatus\tmessage\tsurvived\n' > $@
	@PATH="$(abspath $(BUILD))/bin:$$PATH" BUILD="$(abspath $(BUILD))" THOROUGH=1 FAULTS="$(abspath $@)" \
	    bats --tap tests/faults.bats > $(@D)/log || { cat $(@D)/log; false; }
