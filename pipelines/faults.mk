# Not a study: every fault that the tools survive, tried once more and thoroughly, with what was observed: status and message
# of each case, in build/out/faults/faults.tsv. Fails when one is not survived.

.PHONY: faults
faults: all $(TEST_HELPERS)
	@mkdir -p $(OUT)/faults
	@printf 'fault\tcase\tstatus\tmessage\tsurvived\n' > $(OUT)/faults/faults.tsv
	@PATH="$(abspath $(BUILD))/bin:$$PATH" BUILD="$(abspath $(BUILD))" THOROUGH=1 FAULTS="$(abspath $(OUT))/faults/faults.tsv" \
	    bats --tap tests/faults.bats > $(OUT)/faults/log || { cat $(OUT)/faults/log; false; }
	@cat $(OUT)/faults/faults.tsv
	@awk -F '\t' 'NR > 1 { n++; lost += $$5 != "yes"; split($$1, w, /[ :]/); faults += !seen[w[2]]++ } \
	    END { printf "%d faults, %d cases, %d not survived\n", faults, n, lost; exit lost > 0 || n == 0 }' $(OUT)/faults/faults.tsv
