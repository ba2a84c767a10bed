# Not a study: what takes too long for make check. `make soak` is a dynamic run of a million steps, with memory and energy
# error; `make kills` kills mtled a hundred times and goes on each time (see tests/soak.sh, tests/kills.sh).

.PHONY: soak kills
soak kills: export PATH := $(abspath $(BUILD))/bin:$(PATH)
soak: all
	@mkdir -p $(OUT)/soak
	@bash tests/soak.sh 1000000 > $(OUT)/soak/soak.tsv
	@cat $(OUT)/soak/soak.tsv
	@awk 'NR == 2 && $$1 >= 1e6 && $$2 > 0 && $$3 <= 1.02 * $$2 && $$4 < 2e-3 { good = 1 } END { exit !good }' $(OUT)/soak/soak.tsv

kills: all
	@bash tests/kills.sh 100
