# make tissue: laws of tissue against published figures and closed forms: fibres, Prony series, supports, membranes, friction
#
# The rows are those of these cases of make hard, where each is measured once; the last one has 240 s for each of its meshes.
TISSUE := $(OUT)/tissue
TISSUE_CASES := 30-febio 32-tissue 34-time 35-around 33-friction 36-ventricle

.PHONY: tissue
tissue: $(TISSUE)/tissue.tsv
	@awk -F '\t' '{ printf "%-26s %-58s %11s %11s %9s %9s  %s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7 }' $<
	@! grep -q 'FAIL$$' $<

# The case is what stands before the first colon or comma of a row.
$(TISSUE)/tissue.tsv: $(TISSUE_CASES:%=$(HARD)/%.rows) pipelines/tissue.mk
	@mkdir -p $(@D)
	awk -F '\t' -v OFS='\t' 'BEGIN { print "case", "quantity", "reference", "ours", "difference", "tolerance", "verdict" } \
	    { at = match($$2, /[:,] /); print substr($$2, 1, at - 1), substr($$2, at + 2), $$4, $$3, $$5, $$6, $$7 }' $(filter %.rows,$^) > $@
