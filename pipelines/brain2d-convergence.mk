# make brain2d-convergence: mean error of the brain section against the size of the triangles, six sizes with seven meshes each, by the default
#
# The seven meshes of a size differ by a per cent in it, which is enough for other triangles at the ends of the craniotomy. SIZE-SHARE is the
# mesh of make brain2d in that size, SIZE-SHARE-ends one that is eight times finer at these two points. Errors are against the
# reference that is fine there, and beside it against that of make brain2d. A solution has .dat, .log, .errors, .even.

BRAIN2D_CONVERGENCE := $(OUT)/brain2d-convergence
BRAIN2D_CONVERGENCE_INPUT := examples/brain2d
BRAIN2D_CONVERGENCE_SIZES := 14.6 10.3 7.3 5.2 3.65 2.6
BRAIN2D_CONVERGENCE_SHARES := 0.97 0.98 0.99 1.00 1.01 1.02 1.03
BRAIN2D_CONVERGENCE_EVEN := $(foreach s,$(BRAIN2D_CONVERGENCE_SIZES),$(BRAIN2D_CONVERGENCE_SHARES:%=$(s)-%))
BRAIN2D_CONVERGENCE_NAMES := $(BRAIN2D_CONVERGENCE_EVEN) $(BRAIN2D_CONVERGENCE_EVEN:%=%-ends)

.PHONY: brain2d-convergence
brain2d-convergence: $(BRAIN2D_CONVERGENCE)/convergence.tsv $(BRAIN2D_CONVERGENCE)/brain2d-convergence.png
	@awk -F '\t' '{ printf "%-5s %-6s %11s %15s %9s %9s %9s %6s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' $<
	$(PICTURES)

$(BRAIN2D_CONVERGENCE)/%: export PATH := $(abspath $(BUILD))/bin:$(PATH)

$(BRAIN2D_CONVERGENCE)/%.msh: $(BRAIN2D_CONVERGENCE_INPUT)/brain2d.geo
	@mkdir -p $(@D)
	gmsh -2 -v 1 $< $(shell echo $* | awk -F - '{ print "-setnumber lc", $$1 * $$2, "-setnumber ke", $$3 == "ends" ? 0.125 : 1 }') $(BRAIN2D_SIZES) -o $@

$(BRAIN2D_CONVERGENCE)/%.dat: $(BRAIN2D_CONVERGENCE)/%.msh $(BRAIN2D_CONVERGENCE_INPUT)/brain2d.scene $(addprefix $(BRAIN2D_CONVERGENCE_INPUT)/,load.tsv skull.tsv) \
        $(addprefix $(BUILD)/bin/,nodes ipoints support shapefn mtled)
	(nodes -u mm $< | ipoints | support | shapefn | mtled -v $(BRAIN2D_CONVERGENCE_INPUT)/brain2d.scene) > $@ $(BRAIN2D_LOG)

$(BRAIN2D_CONVERGENCE)/graded.ref: $(BRAIN2D_CONVERGENCE_INPUT)/brain2d_graded.tsv pipelines/reference.awk
$(BRAIN2D_CONVERGENCE)/even.ref: $(BRAIN2D_CONVERGENCE_INPUT)/brain2d_reference.tsv pipelines/reference.awk
$(BRAIN2D_CONVERGENCE)/graded.ref $(BRAIN2D_CONVERGENCE)/even.ref:
	@mkdir -p $(@D)
	awk -f pipelines/reference.awk $< > $@

$(BRAIN2D_CONVERGENCE)/%.errors: $(BRAIN2D_CONVERGENCE)/%.dat $(BRAIN2D_CONVERGENCE)/graded.ref $(BUILD)/bin/fieldcmp
	fieldcmp $(wordlist 1,2,$^) > $@
$(BRAIN2D_CONVERGENCE)/%.even: $(BRAIN2D_CONVERGENCE)/%.dat $(BRAIN2D_CONVERGENCE)/even.ref $(BUILD)/bin/fieldcmp
	fieldcmp $(wordlist 1,2,$^) > $@

$(BRAIN2D_CONVERGENCE)/convergence.tsv: $(BRAIN2D_CONVERGENCE_NAMES:%=$(BRAIN2D_CONVERGENCE)/%.errors) \
        $(BRAIN2D_CONVERGENCE_NAMES:%=$(BRAIN2D_CONVERGENCE)/%.even) pipelines/brain2d-convergence.awk
	awk -f pipelines/brain2d-convergence.awk $(filter %.errors,$^) > $@

$(BRAIN2D_CONVERGENCE)/brain2d-convergence.png: $(BRAIN2D_CONVERGENCE)/convergence.tsv pipelines/plot/brain2d-convergence.gp
	gnuplot -e "data='$<'; out='$@'" pipelines/plot/brain2d-convergence.gp

.SECONDARY: $(foreach n,$(BRAIN2D_CONVERGENCE_NAMES),$(addprefix $(BRAIN2D_CONVERGENCE)/$(n),.msh .dat))
