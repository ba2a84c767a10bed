# make table1: the founding paper's table 1 (errors of MLS and MMLS on a regular and an irregular cloud), its figure 1

TABLE1 := $(OUT)/table1
TABLE1_TOOLS := $(addprefix $(BUILD)/bin/,cloud ipoints support shapefn interp fieldcmp mts)

.PHONY: table1
table1: $(TABLE1)/table1.tsv $(TABLE1)/beside.tsv $(TABLE1)/surface.png
	@awk -f pipelines/table1.awk pipelines/table1-paper.tsv $<
	$(PICTURES)

$(TABLE1)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(TABLE1)/table1.tsv: pipelines/table1.sh pipelines/table1-paper.tsv $(TABLE1_TOOLS)
	@mkdir -p $(@D)
	bash pipelines/table1.sh pipelines/table1-paper.tsv > $@

# Beside the paper's values: rows in the same order.
$(TABLE1)/beside.tsv: $(TABLE1)/table1.tsv pipelines/table1-paper.tsv
	paste pipelines/table1-paper.tsv $< | awk -F '\t' -v OFS='\t' 'NR == 1 { print $$1, $$2, $$3, "regular_paper", "regular", "irregular_paper", "irregular"; next } \
	    { if ($$1 OFS $$2 OFS $$3 != $$6 OFS $$7 OFS $$8) exit 1; print $$1, $$2, $$3, $$4, $$9, $$5, $$10 }' > $@

# The surface through MMLS with few nodes in each support: mu = .1, R = .8.
$(TABLE1)/surface.dat: $(TABLE1_TOOLS)
	@mkdir -p $(@D)
	cloud -d 2 -k regular -n 18,18 --box -4,4,-4,4 --field paper | ipoints --lattice 81,81 | \
	    support -R 0.8 -n 20 --no-widen -b mmls2 --mu 0.1 --mu-unit m | shapefn | interp -t > $@

$(TABLE1)/surface.png: $(TABLE1)/surface.dat pipelines/plot/surface.gp
	paste <(mts print nodes.x $<) <(mts print u $<) | awk '{ print } NR % 81 == 0 { print "" }' > $(@:.png=.tsv)
	gnuplot -e "data='$(@:.png=.tsv)'; out='$@'" pipelines/plot/surface.gp
