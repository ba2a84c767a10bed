# make hard: cases with known answers, each through the tools, with its error and verdict.
#
# Each script of pipelines/hard prints rows of the table, and also runs alone with build/bin on PATH; limits, each with its reason,
# stand in pipelines/hard/tolerances.tsv. tests/hard.bats runs the cases that take seconds. A row that misses
# its tolerance reads FAIL and makes the study fail, after the table is printed.

HARD := $(OUT)/hard
HARD_CASES := $(sort $(notdir $(basename $(wildcard pipelines/hard/[0-9]*.sh))))
HARD_TOOLS := $(addprefix $(BUILD)/bin/,cloud nodes tag fibres ipoints support shapefn mtled interp fieldcmp mts)

.PHONY: hard
hard: $(HARD)/hard.tsv $(HARD)/summary.tsv $(HARD)/misses.tsv
	@awk -F '\t' '{ printf "%-4s %-62s %14s %14s %10s %9s  %s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7 }' $<
	@! grep -q 'FAIL$$' $<

$(HARD)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(HARD_CASES:%=$(HARD)/%.rows): $(HARD)/%.rows: pipelines/hard/%.sh pipelines/hard/common.sh pipelines/hard/tolerances.tsv $(HARD_TOOLS) $(wildcard examples/hard/* examples/ventricle/*)
	@mkdir -p $(@D)
	bash $< > $@

$(HARD)/hard.tsv: $(HARD_CASES:%=$(HARD)/%.rows) pipelines/hard.mk
	(printf 'case\tquantity\tvalue\treference\terror\ttolerance\tverdict\n'; cat $(filter %.rows,$^)) > $@

# What the texts say of it: how many rows, and those that miss their tolerance.
$(HARD)/summary.tsv: $(HARD)/hard.tsv
	awk -F '\t' -v OFS='\t' 'NR > 1 { n[$$7 == "pass"]++ } END { print "verdict", "rows"; print "all", n[0] + n[1]; print "pass", n[1] + 0; print "FAIL", n[0] + 0 }' $< > $@

$(HARD)/misses.tsv: $(HARD)/hard.tsv
	awk -F '\t' -v OFS='\t' 'NR == 1 || $$7 != "pass" { print $$1, $$2, $$3, $$4, $$5, $$6 }' $< > $@
