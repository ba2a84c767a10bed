# Not a study: what takes too long for make check. `make soak` is a dynamic run of a million steps, with memory and energy
# error; `make kills` kills mtled a hundred times and goes on each time (see pipelines/soak/soak.sh, pipelines/soak/kills.sh).

SOAK := $(OUT)/soak/soak.tsv

.PHONY: soak kills
soak: $(SOAK)
	@cat $<
	@awk 'NR == 2 && $$1 >= 1e6 && $$2 > 0 && $$3 <= 1.02 * $$2 && $$4 < 2e-3 { good = 1 } END { exit !good }' $<

$(SOAK) kills: export PATH := $(abspath $(BUILD))/bin:$(PATH)
$(SOAK): $(PROGRAMS) always
	@mkdir -p $(@D)
	@bash pipelines/soak/soak.sh 1000000 > $@

kills: $(PROGRAMS)
	@bash pipelines/soak/kills.sh 100
